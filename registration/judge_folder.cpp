#include "registration/judge_folder.h"

#include <vector>

#include "acquisition/live/recording_folder.h"

namespace fathom {

namespace {

constexpr std::size_t kMostSamples = 500000;  // of the probe, for its jitter: half an hour at 240 Hz

// The probe's raw samples. Empty where nobody knows which they are.
std::vector<TrackerSample> probe_samples(const std::filesystem::path& folder, const Recording& recording,
                                         const FrameNames& names) {
  std::vector<TrackerSample> samples;
  const auto chain = default_pose_chain(recording, names);
  if (!chain || chain->steps.empty()) return samples;
  const std::string& name = recording.header().transforms[chain->steps.front().transform];
  for_each_sample(folder, [&](const TrackerSample& sample) {
    if (sample.transform == name && samples.size() < kMostSamples) samples.push_back(sample);
  });
  return samples;
}

}  // namespace

SweepVerdict judge_folder(const std::filesystem::path& folder, const Calibration* calibration, const FrameNames& names,
                          const VerdictOptions& options) {
  const auto recording = open_recording(folder);
  return judge_sweep(*recording, calibration, names, probe_samples(folder, *recording, names), options);
}

}  // namespace fathom
