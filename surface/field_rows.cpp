#include "surface/field_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <vector>

#include "core/numbers.h"

namespace fathom {

namespace {

class FunctionRows : public FieldRows {
 public:
  FunctionRows(const RowField& field, const Eigen::Vector3d& low_mm, const LatticeLayout& layout,
               const IsosurfaceOptions& options)
      : field_(field),
        low_mm_(low_mm),
        step_mm_(layout.step_mm),
        last_column_(layout.columns - (options.mesher.lattice() == Lattice::kBodyCentred ? 1.5 : 1.0)),
        options_(options) {}

  void sample(const LatticeRow& row, std::span<float> values) const override {
    std::vector<double> field_values(values.size());
    const Eigen::Vector3d step_mm(step_mm_.x(), 0.0, 0.0);
    // Samples that are not a whole step from the next one are asked for alone.
    std::size_t begin = 0;
    std::size_t end = field_values.size();
    if (options_.mesher.lattice() == Lattice::kBodyCentred) {
      const std::size_t alone = row.shifted ? --end : begin++;
      field_(place_mm(row, static_cast<int>(alone)), step_mm, std::span(field_values).subspan(alone, 1));
    }
    field_(place_mm(row, static_cast<int>(begin)), step_mm, std::span(field_values).subspan(begin, end - begin));
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = field_values[i];
      low = std::min(low, value);
      high = std::max(high, value);
      values[i] = std::isfinite(value)
                      ? to_sample(options_.inside_below ? options_.value - value : value - options_.value)
                      : std::numeric_limits<float>::quiet_NaN();
    }
    const std::scoped_lock lock(mutex_);
    low_ = std::min(low_, low);
    high_ = std::max(high_, high);
  }

  std::string fault_at(const LatticeRow& row, int column) const override {
    const Eigen::Vector3d place = place_mm(row, column);
    return "the field is not a finite number at (" + format_real(place.x()) + ", " + format_real(place.y()) + ", " +
           format_real(place.z()) + ") mm; choose a box without such places";
  }

  std::pair<double, double> value_range() const override { return {low_, high_}; }

 private:
  Eigen::Vector3d place_mm(const LatticeRow& row, int column) const {
    const double at = column + first_column(options_.mesher.lattice(), row.shifted);
    return low_mm_ + step_mm_.cwiseProduct(Eigen::Vector3d(std::clamp(at, 0.0, last_column_), row.row, row.layer));
  }

  const RowField& field_;
  Eigen::Vector3d low_mm_;
  Eigen::Vector3d step_mm_;
  double last_column_;  // in steps
  const IsosurfaceOptions& options_;
  mutable std::mutex mutex_;
  mutable double low_ = std::numeric_limits<double>::infinity();
  mutable double high_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

float to_sample(double inside_by) {
  constexpr double kLargest = 1e30;
  constexpr double kSmallest = 1e-30;
  const double size = std::abs(inside_by);
  if (size == 0.0) return 0.0F;
  return static_cast<float>(std::copysign(std::clamp(size, kSmallest, kLargest), inside_by));
}

double first_column(Lattice lattice, bool shifted) { return lattice == Lattice::kBodyCentred && !shifted ? -0.5 : 0.0; }

std::unique_ptr<FieldRows> function_rows(const RowField& field, const Eigen::Vector3d& low_mm,
                                         const LatticeLayout& layout, const IsosurfaceOptions& options) {
  return std::make_unique<FunctionRows>(field, low_mm, layout, options);
}

}  // namespace fathom
