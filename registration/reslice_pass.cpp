#include "registration/reslice_pass.h"

#include <algorithm>
#include <utility>

#include <opencv2/core/utility.hpp>

namespace fathom {

double row_stripes() {
  constexpr int kPerThread = 4;  // so that none waits long for the last
  return kPerThread * cv::getNumThreads();
}

ReslicePass::ReslicePass(const ResliceFrames& frames, const NearFrames& near, const ResliceSurface& surface,
                         std::vector<double> layers_mm, const SpacePartition* partition, int batch_frames)
    : near_(near),
      surface_(surface),
      layers_mm_(std::move(layers_mm)),
      batch_frames_(batch_frames),
      batches_((near.count() + batch_frames - 1) / batch_frames),
      plans_(surface.rows.size() * layers_mm_.size()),
      needed_(static_cast<std::size_t>(near.count()), false) {
  const int rows = static_cast<int>(surface.rows.size());
  cv::parallel_for_(
      cv::Range(0, rows),
      [&](const cv::Range& range) {
        RowRuns finder(frames, near, surface.columns, surface.spacing_mm, partition);
        std::vector<ResliceRun> found;
        for (int v = range.start; v < range.end; ++v) {
          for (int layer = 0; layer < layers(); ++layer) {
            found.clear();
            finder.find(row(v, layer), found);
            divide_into_batches(found, plan(v, layer));
          }
        }
      },
      row_stripes());
  for (const RowPlan& plan : plans_) {
    for (const ResliceRun& run : plan.runs) {
      needed_[static_cast<std::size_t>(run.frame)] = true;
      if (run.pair) needed_[static_cast<std::size_t>(run.frame) + 1] = true;
    }
  }
}

ResliceRow ReslicePass::row(int row, int layer) const {
  ResliceRow shifted = surface_.rows[static_cast<std::size_t>(row)];
  shifted.start_mm += layers_mm_[static_cast<std::size_t>(layer)] * shifted.normal;
  return shifted;
}

std::span<const ResliceRun> ReslicePass::runs(int row, int layer, int batch) const {
  const RowPlan& of_row = plan(row, layer);
  const auto b = static_cast<std::size_t>(batch);
  return std::span(of_row.runs)
      .subspan(static_cast<std::size_t>(of_row.first[b]),
               static_cast<std::size_t>(of_row.first[b + 1] - of_row.first[b]));
}

void ReslicePass::divide_into_batches(const std::vector<ResliceRun>& found, RowPlan& plan) const {
  plan.first.assign(static_cast<std::size_t>(batches_) + 1, static_cast<int>(found.size()));
  plan.first[0] = 0;
  if (batches_ < 2) {
    plan.runs = found;
    return;
  }
  plan.runs.reserve(found.size());
  // Once over the runs for each batch: there are few, and the runs of each stay in the order of their columns.
  for (int batch = 0; batch < batches_; ++batch) {
    plan.first[static_cast<std::size_t>(batch)] = static_cast<int>(plan.runs.size());
    const int first = batch * batch_frames_;
    const int end = first + batch_frames_;
    for (const ResliceRun& run : found) {
      if (run.frame >= first && run.frame < end) plan.runs.push_back(run);
    }
  }
}

}  // namespace fathom
