#include "registration/reslice.h"

#include <chrono>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "acquisition/recording.h"
#include "cli/command.h"
#include "cli/image_area.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/scan_input.h"
#include "core/error.h"
#include "exam/report_picture.h"
#include "registration/dividing_planes.h"
#include "registration/find_sweeps.h"

namespace fathom {

namespace {

constexpr int kMost = std::numeric_limits<int>::max();

struct ResliceCommand {
  ScanInput input;
  std::string out;
  std::vector<double> origin;
  std::vector<double> x_axis;
  std::vector<double> y_axis;
  std::vector<double> size_mm;
  std::optional<double> spacing_mm;
  std::optional<int> through_frame;
  double rotate_deg = 0.0;
  std::vector<std::vector<double>> curve;  // x, y, z of every point
  std::optional<double> height_mm;
  bool panorama = false;
  std::optional<int> sweep;  // from 1
  ImageArea area;
  ReslicerOptions reslicer;
  ResliceOptions reslice;
  bool json = false;
};

// Which surface is asked for: one of four, with what it needs.
void require_one_surface(const ResliceCommand& command) {
  const int asked = static_cast<int>(!command.origin.empty()) + static_cast<int>(command.through_frame.has_value()) +
                    static_cast<int>(!command.curve.empty()) + static_cast<int>(command.panorama);
  const auto wrong = [](const std::string& what) { throw CLI::ValidationError("reslice", what); };
  if (asked != 1) wrong("give one of --origin, --through-frame, --curve and --panorama");
  const auto needs = [&](bool given, const std::string& option, const std::string& for_what) {
    if (!given) wrong(for_what + " needs " + option);
  };
  if (!command.origin.empty()) {
    needs(!command.x_axis.empty(), "--x-axis", "--origin");
    needs(!command.y_axis.empty(), "--y-axis", "--origin");
    needs(!command.size_mm.empty(), "--size-mm", "--origin");
  }
  if (!command.curve.empty()) {
    needs(command.curve.size() > 1, "a second point", "--curve");
    needs(!command.y_axis.empty(), "--y-axis, the direction in which it is swept,", "--curve");
    needs(command.height_mm.has_value(), "--height-mm", "--curve");
  }
}

struct UsedSweeps {
  std::vector<Sweep> sweeps;
  std::optional<SpacePartition> partition;
};

UsedSweeps used_sweeps(const ResliceCommand& command, const std::optional<Exam>& exam, const Recording& recording,
                       const FrameLocator& locator) {
  PlanesFile planes = asked_planes(command.input, exam);
  UsedSweeps used;
  used.sweeps = planes.sweeps.empty() ? find_sweeps(recording, locator) : std::move(planes.sweeps);
  if (command.sweep) {
    if (static_cast<std::size_t>(*command.sweep) > used.sweeps.size()) {
      throw Error(command.input.recording + ": has no sweep " + std::to_string(*command.sweep) +
                  "; its sweeps are 1 to " + std::to_string(used.sweeps.size()));
    }
    used.sweeps = {used.sweeps[static_cast<std::size_t>(*command.sweep - 1)]};
    return used;
  }
  if (planes.planes.empty() && command.input.planes.empty()) return used;
  std::vector<SweepShape> shapes;
  for (const Sweep& sweep : used.sweeps) {
    if (sweep.recording != 0) {
      throw Error(command.input.planes + ": has sweeps of several recordings; give the planes of this one");
    }
    shapes.push_back(sweep_shape(sweep, locator, recording.header().width, recording.header().height));
  }
  used.partition.emplace(std::move(shapes), std::move(planes.planes));
  return used;
}

Eigen::Vector3d vector_of(const std::vector<double>& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

// The plane that is asked for, if it is one.
std::optional<ReslicePlane> asked_plane(const ResliceCommand& command, const Recording& recording,
                                        const FrameLocator& locator, const std::vector<PlacedFrame>& frames,
                                        double spacing_mm) {
  std::optional<cv::Size> size;
  if (!command.size_mm.empty()) {
    size.emplace(pixels_along(command.size_mm[0], spacing_mm), pixels_along(command.size_mm[1], spacing_mm));
  }
  if (!command.origin.empty()) {
    return ReslicePlane{vector_of(command.origin), vector_of(command.x_axis), vector_of(command.y_axis), *size,
                        spacing_mm};
  }
  if (!command.through_frame) return {};
  const int number = *command.through_frame;
  const RecordingHeader& header = recording.header();
  if (number >= header.frame_count()) {
    throw Error(command.input.recording + ": has no frame " + std::to_string(number) + "; its frames are 0 to " +
                std::to_string(header.frame_count() - 1));
  }
  const auto map = locator.reference_from_image(number);
  if (!map) {
    throw Error(command.input.recording + ": frame " + std::to_string(number) +
                " has no valid pose; choose another frame");
  }
  return plane_through({number, *map}, command.rotate_deg * std::numbers::pi / 180.0, frames,
                       {header.width, header.height}, spacing_mm, size ? &*size : nullptr);
}

ResliceSurface asked_surface(const ResliceCommand& command, const Recording& recording,
                             const std::vector<PlacedFrame>& frames, double spacing_mm) {
  if (command.panorama) {
    const cv::Size size(recording.header().width, recording.header().height);
    return panorama_surface(frames, size, 0.5 * (size.width - 1), spacing_mm);
  }
  std::vector<Eigen::Vector3d> points_mm;
  for (const std::vector<double>& point : command.curve) points_mm.push_back(vector_of(point));
  return curved_surface(points_mm, vector_of(command.y_axis), *command.height_mm, spacing_mm);
}

// Grey with an alpha channel: what is not covered is transparent.
cv::Mat with_holes(const Resliced& made) {
  cv::Mat alpha;
  made.covered.convertTo(alpha, made.picture.depth(), made.picture.depth() == CV_16U ? 257.0 : 1.0);
  cv::Mat picture;
  cv::merge(std::vector<cv::Mat>{made.picture, made.picture, made.picture, alpha}, picture);
  return picture;
}

std::string place_text(const Eigen::Vector3d& place_mm) {
  return "(" + number_text(place_mm.x(), 1) + ", " + number_text(place_mm.y(), 1) + ", " +
         number_text(place_mm.z(), 1) + ")";
}

nlohmann::ordered_json json_of(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

void run(const ResliceCommand& command) {
  require_one_surface(command);
  if (std::filesystem::path(command.out).extension() != ".png") {
    throw Error(command.out + ": pictures are written to .png; name the file so");
  }
  const ScanInput& input = command.input;
  const auto exam = read_if_exam(input.recording);
  const std::string calibration_name = calibration_file(input, exam);
  const auto recording = open_only_recording(input.recording, "reslice");
  const Calibration calibration = read_calibration(calibration_name, input.names.probe);
  const FrameLocator locator(*recording, calibration, input.names);
  const UsedSweeps used = used_sweeps(command, exam, *recording, locator);
  ReslicerOptions options = command.reslicer;
  options.clip = command.area.rectangle();
  options.fan = command.area.fan(calibration);
  const Reslicer reslicer(*recording, locator, used.sweeps, options);
  if (recording->header().pixel_type != CV_8UC1 && recording->header().pixel_type != CV_16UC1) {
    throw Error(command.input.recording +
                ": has pixels below 0, which a PNG cannot hold; convert it to unsigned pixels");
  }
  std::vector<PlacedFrame> frames;
  for (const ResliceFrames::Frame& frame : reslicer.frames().frames) frames.push_back(frame.placed);
  const double spacing_mm = command.spacing_mm.value_or(pixel_size_mm(frames.front().reference_from_image));
  const auto plane = asked_plane(command, *recording, locator, frames, spacing_mm);
  const ResliceSurface surface = plane ? plane_surface(*plane) : asked_surface(command, *recording, frames, spacing_mm);

  const auto start = std::chrono::steady_clock::now();
  const Resliced made = reslicer.reslice(surface, command.reslice, used.partition ? &*used.partition : nullptr,
                                         progress_bar("reslicing"));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  write_png(with_holes(made), command.out);

  const double covered = made.covered_share();
  std::vector<std::string> warnings;
  if (covered == 0.0) {
    const cv::Rect image(0, 0, recording->header().width, recording->header().height);
    const Eigen::AlignedBox3d box = box_around(frames, image.tl(), image.br() - cv::Point(1, 1));
    const std::string why = used.partition ? "it lies in other sweeps' parts of space or outside of the B-scans"
                                           : "it lies outside of the B-scans";
    warnings.push_back("the picture shows nothing, as " + why + ", which reach from " + place_text(box.min()) + " to " +
                       place_text(box.max()) + " mm");
  }
  if (command.json) {
    nlohmann::ordered_json json{
        {"width", made.picture.cols}, {"height", made.picture.rows}, {"spacing_mm", spacing_mm}, {"covered", covered}};
    if (plane) {
      json["origin_mm"] = json_of(plane->origin_mm);
      json["x_axis"] = json_of(surface.rows.front().step_mm.normalized());
      json["y_axis"] = json_of(surface.rows.front().normal.cross(surface.rows.front().step_mm).normalized());
    }
    json["seconds"] = seconds;
    json["warnings"] = warnings;
    print_json(json);
    return;
  }
  std::cout << command.out << ": " << made.picture.cols << " x " << made.picture.rows << " pixels of "
            << number_text(spacing_mm, 3) << " mm, " << number_text(100.0 * covered, 1) << " % covered, in "
            << number_text(seconds, 3) << " s\n";
  for (const std::string& warning : warnings) std::cout << "warning: " << warning << "\n";
}

// Numbers with commas between them, `count` for each time that the option is given.
CLI::Option* add_numbers(CLI::App& command, const std::string& name, std::vector<double>& numbers, int count,
                         const std::string& help) {
  return command.add_option(name, numbers, help)->delimiter(',')->expected(count)->check(finite());
}

void add_surface_options(CLI::App& command, ResliceCommand& options) {
  add_numbers(command, "--origin", options.origin, 3, "A plane: x,y,z of the middle of its top left pixel, mm");
  add_numbers(command, "--x-axis", options.x_axis, 3, "The direction of the picture's rows: x,y,z");
  add_numbers(command, "--y-axis", options.y_axis, 3, "The direction downward in the picture: x,y,z");
  add_numbers(command, "--size-mm", options.size_mm, 2, "Width and height of the picture of a plane")
      ->check(above(0.0));
  command.add_option("--through-frame", options.through_frame, "A plane through the middle of this frame instead")
      ->check(CLI::Range(0, kMost));
  command.add_option("--rotate-deg", options.rotate_deg, "Turns it about the image's vertical axis; 90 is across")
      ->check(between(-360.0, 360.0))
      ->capture_default_str();
  add_number_lists(command, "--curve", options.curve, 3, "x,y,z",
                   "A curved picture instead: a point x,y,z of a line that is swept along --y-axis; two or more times");
  command.add_option("--height-mm", options.height_mm, "Height of a curved picture")->check(above(0.0));
  command.add_flag("--panorama", options.panorama, "A picture along the way of the images' middle columns instead");
  command.add_option("--spacing-mm", options.spacing_mm, "Side of a pixel (default: that of the B-scans)")
      ->check(above(0.0));
}

}  // namespace

void add_reslice(CLI::App& app) {
  static const std::map<std::string, ResliceMode> modes = {{"nearest", ResliceMode::kNearest},
                                                           {"linear", ResliceMode::kLinear},
                                                           {"mean", ResliceMode::kMean},
                                                           {"max", ResliceMode::kMax}};
  auto options = std::make_shared<ResliceCommand>();
  CLI::App* command = app.add_subcommand("reslice", "Look at any plane or surface, straight from the B-scans");
  add_recording(*command, options->input.recording);
  add_calibration(*command, options->input);
  command->add_option("--out", options->out, "The picture to write: .png; what is not covered is transparent")
      ->required();
  add_surface_options(*command, *options);
  command
      ->add_option("--mode", options->reslice.mode,
                   "Interpolation: nearest or linear; across a thick slice: mean (of linear) or max (of nearest)")
      ->transform(CLI::CheckedTransformer(modes).description("nearest|linear|mean|max"))
      ->default_str("nearest");
  command
      ->add_option("--thickness-mm", options->reslice.thickness_mm, "A slab about the surface instead of a thin slice")
      ->check(at_least(0.0))
      ->capture_default_str();
  command
      ->add_option("--max-gap-mm", options->reslicer.max_gap_mm,
                   "A wider gap between two frames stays empty (default: four times the usual distance)")
      ->check(above(0.0));
  CLI::Option* const sweep =
      command->add_option("--sweep", options->sweep, "Only this sweep, as fathom sweeps numbers them")
          ->check(CLI::Range(1, kMost));
  command
      ->add_option("--planes", options->input.planes,
                   "Dividing planes (fathom planes): each part shows its sweep (default: the exam's)")
      ->excludes(sweep);
  add_image_area(*command, options->area);
  add_frame_names(*command, options->input.names);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options] { run(*options); });
}

}  // namespace fathom
