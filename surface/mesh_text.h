#pragma once

#include <cstdint>
#include <string_view>

#include <Eigen/Core>

#include "core/atomic_file.h"
#include "core/progress.h"
#include "surface/mesh.h"

namespace fathom {

/// A mesh on its way into a file as text, a line for each vertex, normal and triangle.
class TextPieces {
 public:
  /// The file must outlive this object, and `mesh` tells how many lines are to come.
  TextPieces(AtomicFile& file, const Mesh& mesh, const Progress& progress);

  /// Throws Error when the disk is full or fails.
  void add(std::string_view text) { file_.write(text); }
  void add(std::int64_t number);
  /// The shortest numbers that read back as these, with blanks between.
  void add(const Eigen::Vector3d& vector);

  /// Ends a vertex, normal or triangle. Throws Cancelled.
  void end_line(std::string_view end = "\n");
  void add_line(std::string_view before, const Eigen::Vector3d& vector, std::string_view end = "\n");

  /// Reports that all is done. Throws Cancelled.
  void finish();

 private:
  AtomicFile& file_;
  const Progress& progress_;
  std::uint64_t lines_ = 0;
  std::uint64_t all_lines_;
};

}  // namespace fathom
