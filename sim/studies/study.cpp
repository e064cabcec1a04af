#include "sim/studies/study.h"

#include "core/error.h"
#include "sim/studies/sweeps_table.h"
#include "sim/studies/volume_study.h"

namespace fathom {

const std::vector<const Study*>& all_studies() {
  static const std::vector<const Study*> studies = {&volume_study(), &sweeps_table()};
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
