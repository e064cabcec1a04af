#include "exam/live_confidence.h"

#include <utility>

#include "core/error.h"
#include "exam/divided_confidence.h"
#include "measurement/cross_section.h"

namespace fathom {

namespace {

// Why nothing can be known of a scan, before anything is computed; empty where something may be.
std::string obstacle(const Document& document) {
  try {
    const auto& division = document.division();
    if (division && division->partition.planes().empty()) return "several sweeps without dividing planes have no sum";
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

LiveConfidences::~LiveConfidences() {
  for (const auto& [id, item] : items_) worker_.cancel(item->key);
}

LiveConfidences::Item& LiveConfidences::item(std::size_t structure) {
  const std::uint64_t id = document_.content().ids.at(structure);
  auto& found = items_[id];
  if (!found) {
    found = std::make_shared<Item>();
    found->key = "interval " + std::to_string(id);
  }
  return *found;
}

void LiveConfidences::request() {
  if (!document_.is_calibrated()) return;
  for (std::size_t i = 0; i < document_.structures().size(); ++i) {
    Item& of = item(i);
    const std::uint64_t revision = document_.result_revision(i);
    if (of.requested != revision) start(i, of, revision);
  }
}

void LiveConfidences::start(std::size_t structure, Item& of, std::uint64_t revision) {
  of.requested = revision;
  const Structure& outlined = document_.structures()[structure];
  std::string fault = obstacle(document_);
  if (!fault.empty() || outlined.contours.empty()) {
    worker_.cancel(of.key);
    of.known = {{}, std::move(fault), false, revision};
    return;
  }
  const std::weak_ptr<Item> place = items_.at(document_.content().ids[structure]);
  const auto deliver = [place, revision](Confidence confidence, std::string error) {
    if (const auto item = place.lock()) item->known = {std::move(confidence), std::move(error), false, revision};
  };
  Job job;
  job.key = of.key;
  job.title = "Interval of " + outlined.name;
  job.work = [scan = document_.scan(), division = document_.division(), outlined,
              deliver](const Progress& progress) -> std::function<void()> {
    if (division) {
      return [made = divided_confidence(outlined, *scan, *division, {}, progress), deliver] { deliver(made, {}); };
    }
    const FrameLocator& locator = scan->locators.front();
    const std::vector<CrossSection> sections = cross_sections(outlined, locator, nullptr);
    Confidence made = confidence(outlined, sections, *scan->recordings.front(), locator,
                                 {scan->calibration, scan->names, {}}, progress);
    return [made = std::move(made), deliver] { deliver(made, {}); };
  };
  job.failed = [deliver](const std::string& error) { deliver({}, error); };
  worker_.start(std::move(job));
}

void LiveConfidences::cancel(std::size_t structure) {
  Item& of = item(structure);
  worker_.cancel(of.key);
  if (of.known.revision != of.requested) of.known = {{}, {}, true, of.requested};
}

}  // namespace fathom
