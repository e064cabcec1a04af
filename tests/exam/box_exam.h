#pragma once

#include <cstdlib>

#include "core/text_file.h"
#include "exam/make_exam.h"
#include "tests/exam/scan.h"
#include "tests/scratch_folder.h"

namespace fathom {

/// Makes the exam of the box in `folder`/exam, and has the program keep its own files in `folder`.
inline void make_box_exam(const ScratchFolder& folder) {
  ::setenv("XDG_STATE_HOME", (folder / "state").c_str(), 1);
  write_recording(box_recording(), folder / "box.mha");
  write_text_file(folder / "probe.json", calibration_json(box_calibration()));
  write_text_file(folder / "contours.json", contours_json({box_structure()}));
  ExamParts parts;
  parts.recordings = {folder / "box.mha"};
  parts.calibration = folder / "probe.json";
  parts.contours = folder / "contours.json";
  create_exam(folder / "exam", parts);
}

}  // namespace fathom
