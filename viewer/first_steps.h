#pragma once

#include <vector>

#include "viewer/actions.h"
#include "viewer/session.h"

namespace fathom {

/// What stands in Review while nothing is open: how to begin, from the table of actions, and what was open last.
/// The latter not where names are to be hidden.
void draw_welcome(const std::vector<Action>& actions, bool hides_names);

/// What a pane is for, by its name: "Outline", "Reslice", "Measurements" or "Timeline". Drawn while nothing is open.
void draw_purpose(const char* pane);

/// Says in a pane that needs to know where frames are that there is no calibration, and how to give one: the file that
/// lies beside the recording under its name is offered, never taken unasked.
void draw_calibration_missing(Session& session, const std::vector<Action>& actions);

}  // namespace fathom
