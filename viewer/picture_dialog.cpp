#include "viewer/picture_dialog.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <imgui.h>

#include "core/numbers.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

constexpr const char* kTitle = "Picture";

std::string file_name(std::string pane) {
  std::transform(pane.begin(), pane.end(), pane.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return pane + ".png";
}

}  // namespace

// Why what was typed is no part of the image; empty where it is one, or nothing was typed.
std::string PictureDialog::area_fault(cv::Size image, std::optional<cv::Rect>& area) const {
  const auto values = parse_reals(area_);
  if (values && values->empty()) return {};
  const bool whole = values && values->size() == 4 && std::all_of(values->begin(), values->end(), [](double v) {
                       return v >= 0.0 && v == std::floor(v) && v < 1e6;
                     });
  if (!whole) return "four whole numbers are needed: x y width height";
  const cv::Rect rect(static_cast<int>((*values)[0]), static_cast<int>((*values)[1]), static_cast<int>((*values)[2]),
                      static_cast<int>((*values)[3]));
  if (rect.empty() || (rect & cv::Rect({}, image)) != rect) {
    return "must lie within the image of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
           " pixels";
  }
  area = rect;
  return {};
}

void PictureDialog::draw(FileDialog& files, const std::vector<std::string>& panes, cv::Size image) {
  if (std::exchange(opening_, false)) ImGui::OpenPopup(kTitle);
  if (!ImGui::BeginPopupModal(kTitle, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
  pane_ = std::clamp(pane_, 0, static_cast<int>(panes.size()) - 1);
  ui::combo("##picture of", pane_, panes, 16.0F * ui::em());
  ui::check("Without names", without_names_,
            "No texts of the exam, names of files, or what scanners write into images");
  std::optional<cv::Rect> area;
  std::string fault;
  if (without_names_) {
    ImGui::TextUnformatted("Part of the B-scans that is free of names:");
    ui::text("##picture area", area_, 16.0F * ui::em());
    ImGui::TextUnformatted("x y width height in pixels; empty: no B-scan");
    fault = area_fault(image, area);
    if (!fault.empty()) ui::fault(fault);
  }
  if (ui::button("Choose a file...", nullptr, false, fault.empty())) {
    const std::string& pane = panes[static_cast<std::size_t>(pane_)];
    const PictureRequest request{{}, pane_ == 0 ? std::string() : "pane:" + pane, without_names_, area};
    ImGui::CloseCurrentPopup();
    files.ask("Picture of " + pane, "Write", file_name(pane), [this, request](const std::filesystem::path& file) {
      asked_ = request;
      asked_->file = file.has_extension() ? file : std::filesystem::path(file.string() + ".png");
    });
  }
  ImGui::SameLine();
  if (ui::button("Cancel##picture") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false)) {
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

std::optional<PictureRequest> PictureDialog::take() { return std::exchange(asked_, std::nullopt); }

}  // namespace fathom
