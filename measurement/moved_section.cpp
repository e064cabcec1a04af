#include "measurement/moved_section.h"

namespace fathom {

SectionOutline moved(SectionOutline section, const Eigen::Isometry3d& motion) {
  section.whole.normal = motion.linear() * section.whole.normal;
  section.whole.vector_area_mm2 = motion.linear() * section.whole.vector_area_mm2;
  section.whole.centroid_mm = motion * section.whole.centroid_mm;
  for (Polygon3& outline : section.outlines) {
    for (Eigen::Vector3d& point : outline) point = motion * point;
  }
  return section;
}

SectionOutline grown(SectionOutline section, double by_mm) {
  double perimeter_mm = 0.0;
  for (Polygon3& outline : section.outlines) {
    const Polygon3 before = outline;
    const std::size_t size = before.size();
    for (std::size_t i = 0; i < size; ++i) {
      perimeter_mm += (before[(i + 1) % size] - before[i]).norm();
      const Eigen::Vector3d outward =
          (before[(i + 1) % size] - before[(i + size - 1) % size]).cross(section.whole.normal);
      if (outward.squaredNorm() > 0.0) outline[i] += by_mm * outward.normalized();
    }
  }
  section.whole.vector_area_mm2 += perimeter_mm * by_mm * section.whole.normal;
  return section;
}

}  // namespace fathom
