#pragma once

#include <filesystem>

#include "viewer/session.h"

namespace fathom {

// Work on the open document that takes seconds, beside the frame; results and faults become messages.

/// Fills the frames between drawn ones of the active structure, as one action that can be undone.
void fill_between(Session& session);

/// Results, report, surfaces and pictures into a folder. Anonymous: without names, and of B-scans only what lies in the
/// area drawn by Area, else nothing, as nobody has said what is burned into them.
void export_document(Session& session, const std::filesystem::path& folder, bool anonymous);

}  // namespace fathom
