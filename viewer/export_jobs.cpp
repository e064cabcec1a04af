#include "viewer/export_jobs.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "exam/export_exam.h"
#include "measurement/propagate.h"
#include "registration/find_sweeps.h"

namespace fathom {

namespace {

// Puts contours with a confidence in place of those that were made before.
void take_filled(Session& session, std::uint64_t id, const Structure& filled, int recording) {
  Document& document = *session.document();
  const auto structure = document.index_of(id);
  if (!structure) return;
  document.begin_action("Fill between");
  for (std::size_t i = document.structures()[*structure].contours.size(); i-- > 0;) {
    const Contour& contour = document.structures()[*structure].contours[i];
    if (contour.confidence && contour.recording == recording) document.remove_contour(*structure, i);
  }
  for (Contour contour : filled.contours) {
    if (!contour.confidence) continue;
    contour.recording = recording;
    document.add_contour(*structure, std::move(contour));
  }
  document.end_action();
}

// The box around an area that is drawn on the frame: what the user says is free of names. Empty where none is.
std::optional<SafeArea> drawn_area(const Session& session) {
  const std::vector<Eigen::Vector2d>& ruler = session.view.ruler_px;
  const RecordingHeader* header = session.header();
  if (session.view.tool != Tool::kArea || ruler.size() < 3 || header == nullptr) return std::nullopt;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : ruler) box.extend(point);
  // Pixels that lie in it as a whole: one that is cut may show what is beside.
  const cv::Point low(static_cast<int>(std::ceil(box.min().x() + 0.5)),
                      static_cast<int>(std::ceil(box.min().y() + 0.5)));
  const cv::Point high(static_cast<int>(std::floor(box.max().x() + 0.5)),
                       static_cast<int>(std::floor(box.max().y() + 0.5)));
  if (high.x <= low.x || high.y <= low.y) return std::nullopt;
  const cv::Rect clip = cv::Rect(low, high) & cv::Rect(0, 0, header->width, header->height);
  if (clip.empty()) return std::nullopt;
  return SafeArea{clip, std::nullopt};
}

}  // namespace

void fill_between(Session& session) {
  const auto active = session.active_structure();
  if (!active) return;
  const Document& document = *session.document();
  const int recording = session.view.recording;
  Structure structure = document.structures()[*active];
  std::erase_if(structure.contours, [&](const Contour& contour) { return contour.recording != recording; });
  for (Contour& contour : structure.contours) contour.recording = 0;
  const std::uint64_t id = document.content().ids[*active];
  const std::uint64_t revision = document.structure_revision(*active);
  const auto work = [&session, structure, id, revision, recording, scan = document.scan(),
                     calibrated = document.is_calibrated()](const Progress& progress) -> std::function<void()> {
    const auto index = static_cast<std::size_t>(recording);
    const FrameLocator& locator = scan->locators[index];
    const std::vector<Sweep> sweeps = find_sweeps(*scan->recordings[index], locator);
    const Propagation made =
        propagate(*scan->recordings[index], {structure}, calibrated ? &locator : nullptr, sweeps, {}, progress);
    return [&session, made, id, revision, recording] {
      Document* now = session.document();
      const auto where = now == nullptr ? std::nullopt : now->index_of(id);
      if (!where || now->structure_revision(*where) != revision) {
        session.say("fill between", "the outlines have changed meanwhile, so nothing was filled; try again");
        return;
      }
      session.attempt("fill between", [&] { take_filled(session, id, made.structures.front(), recording); });
      for (const std::string& refused : made.refused) session.say("fill between", refused, false);
    };
  };
  session.worker().start({"fill", "Filling between outlines", work,
                          [&session](const std::string& error) { session.say("fill between", error); }});
}

void export_document(Session& session, const std::filesystem::path& folder, bool anonymous) {
  session.attempt("export", [&] {
    const auto snapshot = std::make_shared<const DocumentSnapshot>(session.document()->snapshot());
    ExportOptions options;
    options.report.program = "fathom";
    options.report.anonymous = anonymous;
    if (anonymous) options.report.area = drawn_area(session);
    const auto work = [&session, snapshot, folder, options](const Progress& progress) -> std::function<void()> {
      const std::vector<std::string> names = export_exam(*snapshot, folder, options, progress);
      return [&session, folder, count = names.size()] {
        session.say("export", std::to_string(count) + " files written to " + folder.string(), false);
      };
    };
    session.worker().start(
        {"export", "Exporting", work, [&session](const std::string& error) { session.say("export", error); }});
  });
}

}  // namespace fathom
