#include "sim/laboratory/table_text.h"

#include <algorithm>

namespace fathom {

namespace {

constexpr std::size_t kLineWidth = 120;
constexpr std::size_t kNarrowest = 3;  // the line below the head has three dashes at least

std::string escaped(const std::string& cell) {
  std::string text;
  for (const char c : cell) {
    if (c == '|' || c == '\\') text += '\\';
    text += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return text;
}

// Characters, not bytes: UTF-8 continues a character by bytes of the form 10xxxxxx.
std::size_t columns_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

// A column of numbers holds digits, signs, brackets and the dash that stands for none, but no words.
bool is_number(const std::string& cell) {
  return cell.find_first_not_of("0123456789+-.,;()[]% <>eE:") == std::string::npos;
}

struct Column {
  std::size_t width = kNarrowest;
  bool numbers = true;
};

std::vector<Column> columns_of_table(const StudyTable& table) {
  std::vector<Column> columns(table.columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    columns[i].width = std::max(columns[i].width, columns_of(escaped(table.columns[i])));
    for (const auto& row : table.rows) {
      if (i >= row.size()) continue;
      columns[i].width = std::max(columns[i].width, columns_of(escaped(row[i])));
      columns[i].numbers = columns[i].numbers && is_number(row[i]);
    }
  }
  return columns;
}

std::string line_of(const std::vector<std::string>& cells, const std::vector<Column>& columns) {
  std::string line = "|";
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string cell = i < cells.size() ? escaped(cells[i]) : "";
    const std::string padding(columns[i].width - columns_of(cell), ' ');
    line += " " + (columns[i].numbers ? padding + cell : cell + padding) + " |";
  }
  return line + "\n";
}

std::string quoted(const std::string& cell) {
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string text = "\"";
  for (const char c : cell) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

std::string csv_line(const std::vector<std::string>& cells, std::size_t count) {
  std::string line;
  for (std::size_t i = 0; i < count; ++i) line += (i == 0 ? "" : ",") + (i < cells.size() ? quoted(cells[i]) : "");
  return line + "\r\n";
}

// Lines of at most kLineWidth characters, where words allow it.
std::string wrapped(const std::string& text) {
  std::string lines;
  std::size_t width = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
    const std::string word = text.substr(at, end - at);
    at = end + 1;
    if (word.empty()) continue;
    const bool fits = width + 1 + columns_of(word) <= kLineWidth;
    lines += (width == 0 ? "" : fits ? " " : "\n") + word;
    width = (fits && width > 0 ? width + 1 : 0) + columns_of(word);
  }
  return lines + "\n";
}

}  // namespace

std::string table_markdown(const StudyTable& table) {
  const std::vector<Column> columns = columns_of_table(table);
  std::string text = line_of(table.columns, columns) + "|";
  for (const Column& column : columns) {
    text += " " + std::string(column.width - (column.numbers ? 1 : 0), '-') + (column.numbers ? ":" : "") + " |";
  }
  text += "\n";
  for (const auto& row : table.rows) text += line_of(row, columns);
  return text;
}

std::vector<bool> number_columns(const StudyTable& table) {
  std::vector<bool> numbers;
  for (const Column& column : columns_of_table(table)) numbers.push_back(column.numbers);
  return numbers;
}

std::string table_csv(const StudyTable& table) {
  std::string text = csv_line(table.columns, table.columns.size());
  for (const auto& row : table.rows) text += csv_line(row, table.columns.size());
  return text;
}

std::string table_text(const StudyTable& table) {
  return table.title + "\n\n" + table_markdown(table) + (table.remark.empty() ? "" : "\n" + wrapped(table.remark));
}

std::string report_markdown(const std::string& title, const StudyReport& report, const std::string& heading) {
  std::string text = heading + " " + title + "\n";
  for (const StudyTable& table : report.tables) {
    text += "\n" + heading + "# " + table_text(table);
  }
  if (report.goals.empty()) return text;
  StudyTable goals;
  goals.columns = {"goal", "wanted", "measured", ""};
  for (const StudyGoal& goal : report.goals) {
    goals.rows.push_back({goal.what, goal.wanted, goal.measured, goal.met ? "met" : "NOT MET"});
  }
  return text + "\n" + heading + "# Goals\n\n" + table_markdown(goals);
}

}  // namespace fathom
