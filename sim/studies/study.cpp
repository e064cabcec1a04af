#include "sim/studies/study.h"

#include "core/error.h"
#include "sim/studies/bladder_study.h"
#include "sim/studies/calibration_study.h"
#include "sim/studies/chain_study.h"
#include "sim/studies/disturbance_study.h"
#include "sim/studies/interval_study.h"
#include "sim/studies/latency_study.h"
#include "sim/studies/mesher_study.h"
#include "sim/studies/sweeps_table.h"
#include "sim/studies/truth_study.h"
#include "sim/studies/volume_study.h"

namespace fathom {

std::uint64_t case_seed(const StudyOptions& options, int index) {
  // The mixing of SplitMix64: seeds that differ by one end far apart.
  std::uint64_t x = options.seed * 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(index) + 1;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

const std::vector<const Study*>& all_studies() {
  // One a line, so that studies are added without touching others.
  static const std::vector<const Study*> studies = {
      &volume_study(),           //
      &unsteady_study(),         //
      &misregistration_study(),  //
      &mesher_study(),           //
      &sweeps_table(),           //
      &bladder_study(),          //
      &calibration_study(),      //
      &latency_study(),          //
      &interval_study(),         //
      &chain_study(),            //
      &truth_study(),            //
  };
  return studies;
}

const Study& study_of(const std::string& name) {
  std::string names;
  for (const Study* study : all_studies()) {
    if (study->name() == name) return *study;
    names += (names.empty() ? "" : ", ") + study->name();
  }
  throw Error("there is no study '" + name + "'; choose from: " + names);
}

}  // namespace fathom
