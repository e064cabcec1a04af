#include "surface/mesh_text.h"

#include <string>

#include "core/numbers.h"

namespace fathom {

TextPieces::TextPieces(AtomicFile& file, const Mesh& mesh, const Progress& progress)
    : file_(file),
      progress_(progress),
      all_lines_(mesh.vertices.size() + mesh.normals.size() + mesh.triangles.size()) {}

void TextPieces::add(std::int64_t number) { file_.write(std::to_string(number)); }

void TextPieces::add(const Eigen::Vector3d& vector) {
  file_.write(format_real(vector.x()) + ' ' + format_real(vector.y()) + ' ' + format_real(vector.z()));
}

void TextPieces::end_line(std::string_view end) {
  constexpr std::uint64_t kLinesBetweenReports = 1 << 16;
  file_.write(end);
  if (lines_++ % kLinesBetweenReports == 0) {
    report(progress_, static_cast<double>(lines_) / static_cast<double>(all_lines_));
  }
}

void TextPieces::add_line(std::string_view before, const Eigen::Vector3d& vector, std::string_view end) {
  add(before);
  add(vector);
  end_line(end);
}

void TextPieces::finish() { report(progress_, 1.0); }

}  // namespace fathom
