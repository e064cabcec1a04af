#include "measurement/surface_gap.h"

#include <algorithm>
#include <optional>

#include <opencv2/core/utility.hpp>

#include "measurement/curved_gap.h"

namespace fathom {

namespace {

int layers_of_gap(const SurfaceSection& first, const SurfaceSection& second, double spacing_mm) {
  return layers_between(distance_between(first, second).lattice_mm, spacing_mm);
}

void make_gap(const std::vector<SurfaceSection>& sections, const ContourLattice& lattice, bool curved, std::size_t i,
              std::vector<SurfaceGap>& gaps) {
  std::optional<CurvedGap> bent;
  if (curved) {
    bent.emplace(*gaps[i].between, i > 0 ? gaps[i - 1].between.get() : nullptr,
                 i + 1 < gaps.size() ? gaps[i + 1].between.get() : nullptr);
  }
  gaps[i].layers = gap_layers(lattice, *gaps[i].between,
                              layers_of_gap(sections[i], sections[i + 1], lattice.spacing_mm), bent ? &*bent : nullptr);
}

}  // namespace

std::vector<SurfaceGap> surface_gaps(const std::vector<SurfaceSection>& sections, const std::vector<SurfaceGap>& before,
                                     Guide guide, bool curved) {
  std::vector<SurfaceGap> gaps(sections.size() - 1);
  cv::parallel_for_(cv::Range(0, static_cast<int>(gaps.size())), [&](const cv::Range& range) {
    for (int index = range.start; index < range.end; ++index) {
      const auto i = static_cast<std::size_t>(index);
      const PlacedSection first = sections[i].placed();
      const PlacedSection second = sections[i + 1].placed();
      const auto same = std::find_if(before.begin(), before.end(),
                                     [&](const SurfaceGap& gap) { return gap.is_between(first.shape, second.shape); });
      gaps[i].between = same != before.end() ? same->between : std::make_shared<const SectionGap>(first, second, guide);
    }
  });
  if (!curved) return gaps;
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    const bool last = i + 1 == gaps.size();
    gaps[i].beyond = {i > 0 ? sections[i - 1].shape : nullptr, last ? nullptr : sections[i + 2].shape};
  }
  return gaps;
}

std::int64_t count_layers(const std::vector<SurfaceSection>& sections, double spacing_mm) {
  std::int64_t layers = 1;
  for (std::size_t i = 1; i < sections.size(); ++i) layers += layers_of_gap(sections[i - 1], sections[i], spacing_mm);
  return layers;
}

std::vector<int> keep_layers(std::vector<SurfaceGap>& gaps, const std::vector<SurfaceGap>& before) {
  std::vector<int> to_make;
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    SurfaceGap& gap = gaps[i];
    const auto same = std::find_if(before.begin(), before.end(), [&](const SurfaceGap& other) {
      return other.between == gap.between && other.beyond == gap.beyond;
    });
    if (same != before.end()) {
      gap.layers = same->layers;
    } else {
      to_make.push_back(static_cast<int>(i));
    }
  }
  return to_make;
}

void make_layers(const std::vector<SurfaceSection>& sections, const std::vector<int>& to_make,
                 const ContourLattice& lattice, bool curved, std::vector<SurfaceGap>& gaps, const Progress& progress) {
  // Little by little, so that the listener is asked often enough.
  const int at_once = std::max(1, cv::getNumThreads());
  const int count = static_cast<int>(to_make.size());
  for (int begin = 0; begin < count; begin += at_once) {
    report(progress, static_cast<double>(begin) / count);
    cv::parallel_for_(
        cv::Range(begin, std::min(begin + at_once, count)),
        [&](const cv::Range& range) {
          for (int k = range.start; k < range.end; ++k) {
            make_gap(sections, lattice, curved, static_cast<std::size_t>(to_make[static_cast<std::size_t>(k)]), gaps);
          }
        },
        at_once);
  }
}

}  // namespace fathom
