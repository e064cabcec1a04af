#pragma once

#include <string>

#include "sim/studies/study.h"

namespace fathom {

/// A table in Markdown, its columns aligned so that it can be read as it stands: numbers to the right. What would break
/// it is escaped.
std::string table_markdown(const StudyTable& table);

/// Which columns hold numbers only, or what stands for them.
std::vector<bool> number_columns(const StudyTable& table);

/// RFC 4180: lines end in CR LF, cells are quoted where they must be.
std::string table_csv(const StudyTable& table);

/// Title, table and remark.
std::string table_text(const StudyTable& table);

/// Title, all tables with their remarks, and the goals of a study in Markdown; `heading` is that of its level, "##".
std::string report_markdown(const std::string& title, const StudyReport& report, const std::string& heading);

}  // namespace fathom
