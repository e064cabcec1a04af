#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace fathom {

/// A closed line in an image, in pixels; the last point joins the first.
using Polygon = std::vector<Eigen::Vector2d>;

/// A polygon drawn on one frame. Several on one frame combine by even-odd: one inside another is a hole.
struct Contour {
  int frame = 0;       ///< as stored in the recording, from 0
  Polygon points_px;   ///< MF orientation; at least three
  bool closed = true;  ///< false: the ends are not joined (they lie where another sweep sees the organ better)
  std::optional<double> confidence;  ///< in [0, 1]; empty for a contour that a person drew
  int recording = 0;                 ///< index in the exam
};

/// A frame on which the structure was looked for and is not there.
struct AbsentMark {
  int frame = 0;
  int recording = 0;
};

/// A frame that only touches the structure, at one point: a cross-section of zero area.
struct Extremity {
  int frame = 0;
  Eigen::Vector2d point_px = Eigen::Vector2d::Zero();
  int recording = 0;
};

/// Why a text cannot be the name of a structure, for the user: "is empty", "must not contain control characters", "is
/// too long for a name". Empty where it can.
std::optional<std::string> name_fault(const std::string& name);

inline constexpr double kUsualOpacity = 0.55;

/// One organ or lesion, as outlined.
struct Structure {
  std::string name;
  std::string color = "#33ccff";  ///< "#rrggbb"
  std::vector<Contour> contours;
  std::vector<AbsentMark> absent;
  std::vector<Extremity> extremities;
  double opacity = kUsualOpacity;  ///< of its surface where it is shown, in [0, 1]
};

/// Reads a contours file (docs/file-formats.md). Throws Error when it is damaged: wrong types, points that are not
/// finite or farther than 1e6 pixels away, fewer than three or more than 1e6 points, negative frames, names used
/// twice, a colour that is not "#rrggbb", an opacity out of [0, 1], a frame both outlined and marked absent or as an
/// extremity; or when it holds more than 6 million values (2 million points). Keys that it does not know are passed
/// over.
std::vector<Structure> read_contours(const std::filesystem::path& path);

/// The text of a contours file, frames ascending; reads back as the same structures.
std::string contours_json(const std::vector<Structure>& structures);

/// Throws Error when structures cannot be measured on a recording of `frame_count` frames: a contour, extremity or mark
/// stands on a frame that it does not have or on another recording of an exam, or a contour is open. `file` is the
/// contours file, for the message.
void require_measurable(const std::vector<Structure>& structures, int frame_count, const std::string& file);

/// What becomes of contours that are open.
enum class OpenContours {
  kRefuse,
  kAllow  ///< their ends may lie where another sweep is used
};

/// The same on the recordings of an exam, which have so many frames each.
void require_measurable(const std::vector<Structure>& structures, const std::vector<int>& frame_counts,
                        OpenContours open, const std::string& file);

/// A warning for the user where outlines reach farther out of the image than a quarter of its size: they may have been
/// drawn on another recording. Allowed, since an organ may be larger than the image. `width` and `height` in pixels.
std::optional<std::string> outside_image_warning(const Structure& structure, int width, int height);

}  // namespace fathom
