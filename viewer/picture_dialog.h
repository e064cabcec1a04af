#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "viewer/file_dialog.h"

namespace fathom {

/// A picture of a part of the window that the user asked for.
struct PictureRequest {
  std::filesystem::path file;
  std::string item;              ///< "pane:Outline"; empty: the whole window
  bool without_names = false;    ///< neither names nor what scanners write into images
  std::optional<cv::Rect> area;  ///< what may be shown of B-scans then; none of them where it is empty
};

/// Asks of what a picture is to be made, and into which file.
class PictureDialog {
 public:
  void ask() { opening_ = true; }
  /// `panes` are the names of those that are shown. `image` is the size of the shown recording's images.
  void draw(FileDialog& files, const std::vector<std::string>& panes, cv::Size image);
  /// What was asked for since.
  std::optional<PictureRequest> take();

 private:
  std::string area_fault(cv::Size image, std::optional<cv::Rect>& area) const;

  bool opening_ = false;
  int pane_ = 0;
  bool without_names_ = false;
  std::string area_;
  std::optional<PictureRequest> asked_;
};

}  // namespace fathom
