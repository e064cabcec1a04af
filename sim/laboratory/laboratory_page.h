#pragma once

#include <string>
#include <vector>

#include "sim/laboratory/study_results.h"

namespace fathom {

/// A file of a study's report as it stands in the page.
struct PageImage {
  std::string title;
  std::string type;  ///< "image/png"
  std::vector<unsigned char> bytes;
};

/// One study of the page.
struct PageStudy {
  StudyResults results;  ///< of which the values are not used
  std::string title;
  StudyReport report;  ///< of which plots and pictures are not used: these are `plots` and `pictures`
  std::vector<PageImage> plots;
  std::vector<PageImage> pictures;
};

/// One page for all studies, which needs no other file and can be printed. `notes` stand at its top.
std::string laboratory_page(const std::vector<PageStudy>& studies, const std::vector<std::string>& notes);

/// The same in Markdown, without plots and pictures.
std::string laboratory_markdown(const std::vector<PageStudy>& studies, const std::vector<std::string>& notes);

}  // namespace fathom
