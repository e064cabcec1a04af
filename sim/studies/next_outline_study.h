#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace fathom {

/// Sections needed on one row of Treece 2000, table 2.1, for a volume within 1 %, sustained up to 20: outlined where
/// the program asks for the next outline, and evenly spaced over the same scan.
struct NextOutlineRow {
  std::string object;
  std::string pattern;
  std::optional<int> asked;       ///< by quadric planimetry
  std::optional<int> even;        ///< by quadric planimetry
  std::optional<int> even_cubic;  ///< by cubic planimetry, the published method
};

/// Scans with 401 frames, both ends and the middle outlined first; from three sections on.
std::vector<NextOutlineRow> next_outline_study();
std::string next_outline_text(const std::vector<NextOutlineRow>& rows);

/// What is made of a scan without its outer tenths: errors of the volume in percent, as measured and with the missing
/// ends added.
struct MissingEndsRow {
  std::string object;
  std::string pattern;
  std::array<double, 3> measured_percent{};   ///< with 7, 11 and 21 sections
  std::array<double, 3> corrected_percent{};  ///< the same
  bool both_told = true;                      ///< an estimate at both ends for each number of sections
};
std::vector<MissingEndsRow> missing_ends_study();
std::string missing_ends_text(const std::vector<MissingEndsRow>& rows);

}  // namespace fathom
