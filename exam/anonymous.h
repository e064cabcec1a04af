#pragma once

#include <memory>
#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

#include "acquisition/recording.h"
#include "exam/document.h"
#include "registration/fan_mask.h"

namespace fathom {

/// The part of the images that shows the patient and nothing that scanners write beside it.
struct SafeArea {
  cv::Rect clip;           ///< pixels, within the image
  std::optional<Fan> fan;  ///< of that; all of it where empty
};

/// An exam without patient, operator, date, notes and keys that are not Fathom's: any of them may tell who it is.
Exam without_names(const Exam& exam);

/// A text in which the document's files are "recording 1", ..., and its folder "exam": names of files tell names, too.
std::string without_file_names(std::string text, const DocumentSnapshot& document);

/// A recording whose images are black outside of an area, and that has no more than poses, times and statuses: header
/// fields and frame fields that Fathom does not know may hold names. `recording` must live as long.
class MaskedRecording : public Recording {
 public:
  /// Throws Error when the area does not lie within the image, and as Fan::check.
  MaskedRecording(const Recording& recording, const SafeArea& area, std::string name);
  cv::Mat image(int frame) const override;

 private:
  const Recording& recording_;
  PixelArea area_;
};

}  // namespace fathom
