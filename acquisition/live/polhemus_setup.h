#pragma once

#include <stop_token>
#include <string>

#include "acquisition/live/polhemus_line.h"

namespace fathom {

/// Finds out which instrument is on the line, where the line does not tell, and has it send records by itself:
/// position in centimetres and quaternion of every station, with clock, frame count and distortion where it has them.
///
/// That the instrument is set to centimetres is asked back, and a first record is waited for: an instrument that
/// measures in inches or sends another list is never believed. Throws Error, naming the source `name`, when nothing
/// answers, the answers are not those of a FASTRAK, PATRIOT or LIBERTY, it refuses a command, or asked to stop.
PolhemusFormat set_up_polhemus(PolhemusLine& line, const std::string& name, bool text, const std::stop_token& stop);

/// Has the instrument stop sending. Throws Error when it is gone.
void stop_polhemus(PolhemusLine& line, PolhemusModel model);

}  // namespace fathom
