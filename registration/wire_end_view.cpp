#include "registration/wire_end_view.h"

#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "core/error.h"

namespace fathom {

namespace {

constexpr double kParallel = 0.02;  // radians: wires are strung through drilled holes

}  // namespace

Eigen::Matrix2d canonical_from_image(ImageOrientation orientation) {
  // Row by row, in the order of ImageOrientation.
  constexpr std::array<std::array<double, 4>, 8> kRows = {{{1, 0, 0, 1},
                                                           {-1, 0, 0, 1},
                                                           {1, 0, 0, -1},
                                                           {-1, 0, 0, -1},
                                                           {0, 1, 1, 0},
                                                           {0, -1, 1, 0},
                                                           {0, 1, -1, 0},
                                                           {0, -1, -1, 0}}};
  static_assert(kRows.size() == kImageOrientations.size());
  const auto& rows = kRows[static_cast<std::size_t>(orientation)];
  Eigen::Matrix2d matrix;
  matrix << rows[0], rows[1], rows[2], rows[3];
  return matrix;
}

WireEndView wire_end_view(const WirePhantom& phantom) {
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
  for (const NPattern& pattern : phantom.patterns) {
    along += (pattern[0].back - pattern[0].front).normalized() + (pattern[2].back - pattern[2].front).normalized();
    across += pattern[2].front - pattern[0].front;
  }
  along.normalize();
  across = (across - along * along.dot(across)).normalized();
  Eigen::Vector3d down = across.cross(along);
  const NPattern& first = phantom.patterns.front();
  const NPattern& last = phantom.patterns.back();
  if (down.dot(last[0].front + last[2].front - first[0].front - first[2].front) < 0.0) down = -down;

  WireEndView view;
  view.phantom_from_view << across, along, down;
  const auto seen = [&](const Eigen::Vector3d& x) { return Eigen::Vector2d(across.dot(x), down.dot(x)); };
  for (const NPattern& pattern : phantom.patterns) {
    WireEndView::Pattern& to = view.patterns.emplace_back();
    to.left = seen((pattern[0].front + pattern[0].back) / 2.0);
    to.right = seen((pattern[2].front + pattern[2].back) / 2.0);
    const Eigen::Vector2d span = to.right - to.left;
    to.front_ratio = (seen(pattern[1].front) - to.left).dot(span) / span.squaredNorm();
    to.back_ratio = (seen(pattern[1].back) - to.left).dot(span) / span.squaredNorm();
    to.front_mm = along.dot(pattern[1].front);
    to.back_mm = along.dot(pattern[1].back);
  }
  return view;
}

void require_usable(const WirePhantom& phantom) {
  const auto refuse = [&](const std::string& what) {
    throw Error("wire phantom" + (phantom.name.empty() ? "" : " \"" + phantom.name + "\"") + ": " + what +
                "; correct the phantom's description");
  };
  if (phantom.patterns.empty()) refuse("it has no N of three wires");
  std::optional<Eigen::Vector3d> common;
  for (std::size_t k = 0; k < phantom.patterns.size(); ++k) {
    const NPattern& pattern = phantom.patterns[k];
    const std::string name = "pattern " + std::to_string(k + 1);
    for (const Wire& wire : pattern) {
      if (!wire.front.allFinite() || !wire.back.allFinite()) refuse(name + " has an end that is not a finite number");
      if ((wire.back - wire.front).norm() < kLeastPatternSize_mm) refuse(name + " has a wire shorter than 1 mm");
    }
    for (const std::size_t outer : {std::size_t{0}, std::size_t{2}}) {
      const Eigen::Vector3d along = (pattern[outer].back - pattern[outer].front).normalized();
      if (!common) common = along;
      if (common->cross(along).norm() > kParallel || common->dot(along) < 0.0) {
        refuse("the outer wires of " + name + " do not run as those of the others, front to back");
      }
    }
    const Eigen::Vector3d across = pattern[2].front - pattern[0].front;
    if ((across - *common * common->dot(across)).norm() < kLeastPatternSize_mm) refuse(name + " is narrower than 1 mm");
    const Eigen::Vector3d middle = pattern[1].back - pattern[1].front;
    if (std::abs(middle.dot(across)) < 0.01 * across.squaredNorm()) {
      refuse("the middle wire of " + name + " does not run from one side to the other");
    }
  }
  const WireEndView view = wire_end_view(phantom);
  for (std::size_t a = 0; a < view.patterns.size(); ++a) {
    for (std::size_t b = a + 1; b < view.patterns.size(); ++b) {
      if (std::abs(view.patterns[a].left.y() - view.patterns[b].left.y()) < kLeastPatternSize_mm) {
        refuse("patterns " + std::to_string(a + 1) + " and " + std::to_string(b + 1) + " are at the same depth");
      }
      if (view.patterns[a].left.y() > view.patterns[b].left.y()) {
        refuse("patterns are not listed from the one nearest to the probe to the farthest");
      }
    }
  }
}

double phantom_width_mm(const WirePhantom& phantom) {
  double width = 0.0;
  for (const WireEndView::Pattern& pattern : wire_end_view(phantom).patterns) {
    width += (pattern.right - pattern.left).norm() / static_cast<double>(phantom.patterns.size());
  }
  return width;
}

}  // namespace fathom
