#include "viewer/file_dialog.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include <imgui.h>

#include "viewer/widgets.h"

namespace fathom {

namespace {

constexpr std::size_t kMostEntries = 5000;

}  // namespace

void FileDialog::ask(std::string title, std::string button, std::string name,
                     std::function<void(const std::filesystem::path&)> chosen) {
  title_ = std::move(title);
  button_ = std::move(button);
  name_ = std::move(name);
  chosen_ = std::move(chosen);
  std::error_code error;
  if (folder_.empty()) folder_ = std::filesystem::current_path(error);
  open_ = appearing_ = true;
  list_folder();
}

void FileDialog::list_folder() {
  entries_.clear();
  error_.clear();
  std::error_code error;
  std::filesystem::directory_iterator entry(folder_, error);
  if (error) {
    error_ = folder_.string() + ": cannot be listed (" + error.message() + ")";
    return;
  }
  for (; entry != std::filesystem::directory_iterator() && entries_.size() < kMostEntries; entry.increment(error)) {
    if (error) break;
    const std::string name = entry->path().filename().string();
    if (name.starts_with('.')) continue;
    std::error_code kind;
    const bool folder = entry->is_directory(kind);
    entries_.push_back({name, folder, folder && std::filesystem::exists(entry->path() / "exam.json", kind)});
  }
  std::sort(entries_.begin(), entries_.end(),
            [](const Entry& a, const Entry& b) { return a.folder != b.folder ? a.folder : a.name < b.name; });
}

void FileDialog::pick(const std::filesystem::path& path) {
  open_ = false;
  ImGui::CloseCurrentPopup();
  if (chosen_) chosen_(path);
}

void FileDialog::draw() {
  if (!open_) return;
  const std::string id = title_ + "##file dialog";
  if (appearing_) ImGui::OpenPopup(id.c_str());
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowSize({std::min(42.0F * ui::em(), 0.9F * screen.x), std::min(32.0F * ui::em(), 0.9F * screen.y)},
                           ImGuiCond_Appearing);
  if (!ImGui::BeginPopupModal(id.c_str(), &open_, ImGuiWindowFlags_NoCollapse)) return;
  ImGui::TextWrapped("%s", folder_.string().c_str());
  if (ui::button("Up")) {
    folder_ = folder_.parent_path();
    list_folder();
  }
  ImGui::BeginChild("entries", {0.0F, -4.0F * ui::em()}, true);
  if (!error_.empty()) ImGui::TextWrapped("%s", error_.c_str());
  for (const Entry& entry : entries_) {
    const std::string shown = (entry.exam ? "[exam] " : entry.folder ? "[folder] " : "") + entry.name;
    if (ImGui::Selectable(shown.c_str(), name_ == entry.name, ImGuiSelectableFlags_AllowDoubleClick)) {
      name_ = entry.name;
      if (ImGui::IsMouseDoubleClicked(0)) {
        if (entry.folder && !entry.exam) {
          folder_ /= entry.name;
          name_.clear();
          list_folder();
        } else {
          pick(folder_ / entry.name);
        }
        break;
      }
    }
    ui::note_last("entry:" + entry.name);
  }
  ImGui::EndChild();
  if (appearing_) ImGui::SetKeyboardFocusHere();
  appearing_ = false;
  ui::text("Name", name_, -4.0F * ui::em());
  const bool entered = ImGui::IsItemFocused() && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false);
  if ((ui::button(button_.c_str(), nullptr, false, !name_.empty()) || entered) && !name_.empty()) {
    const std::filesystem::path typed(name_);
    pick(typed.is_absolute() ? typed : folder_ / typed);
  }
  ImGui::SameLine();
  if (ui::button("Cancel##file dialog") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false)) {
    open_ = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace fathom
