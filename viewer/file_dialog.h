#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace fathom {

/// Asks for a file or folder, in a window of its own above the panes.
class FileDialog {
 public:
  /// `chosen` gets what was typed or picked. `name` is what stands in the field at first.
  void ask(std::string title, std::string button, std::string name,
           std::function<void(const std::filesystem::path&)> chosen);
  void draw();
  bool is_open() const { return open_; }

 private:
  void list_folder();
  void pick(const std::filesystem::path& path);

  struct Entry {
    std::string name;
    bool folder = false;
    bool exam = false;
  };

  bool open_ = false;
  bool appearing_ = false;
  std::string title_;
  std::string button_;
  std::string name_;
  std::filesystem::path folder_;
  std::vector<Entry> entries_;
  std::string error_;
  std::function<void(const std::filesystem::path&)> chosen_;
};

}  // namespace fathom
