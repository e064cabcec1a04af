#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "registration/partition.h"
#include "registration/reslice_frames.h"

namespace fathom {

/// How many parts rows are dealt in to threads: each has scratch memory of its own, so that they are not too many.
double row_stripes();

/// Parallel layers of a surface, planned: which frames show which columns of their rows, in batches of frames that
/// follow each other.
class ReslicePass {
 public:
  /// `layers_mm` are the layers' places along the surface's normals. Each batch has `batch_frames` frames and, for
  /// pairs, the first of the next. What is given is kept by reference.
  ReslicePass(const ResliceFrames& frames, const NearFrames& near, const ResliceSurface& surface,
              std::vector<double> layers_mm, const SpacePartition* partition, int batch_frames);

  int batches() const { return batches_; }
  /// In NearFrames: the first frame of a batch, and one after its last, with the first of the next batch.
  int first_frame(int batch) const { return batch * batch_frames_; }
  int end_frame(int batch) const { return std::min((batch + 1) * batch_frames_ + 1, near_.count()); }
  bool needed(int frame) const { return needed_[static_cast<std::size_t>(frame)]; }

  int layers() const { return static_cast<int>(layers_mm_.size()); }
  ResliceRow row(int row, int layer) const;
  std::span<const ResliceRun> runs(int row, int layer, int batch) const;

 private:
  struct RowPlan {
    std::vector<ResliceRun> runs;  ///< batch after batch
    std::vector<int> first;        ///< of every batch, and the end
  };

  void divide_into_batches(const std::vector<ResliceRun>& found, RowPlan& plan) const;
  RowPlan& plan(int row, int layer) { return plans_[static_cast<std::size_t>(row * layers() + layer)]; }
  const RowPlan& plan(int row, int layer) const { return plans_[static_cast<std::size_t>(row * layers() + layer)]; }

  const NearFrames& near_;
  const ResliceSurface& surface_;
  std::vector<double> layers_mm_;
  int batch_frames_;
  int batches_;
  std::vector<RowPlan> plans_;
  std::vector<bool> needed_;
};

}  // namespace fathom
