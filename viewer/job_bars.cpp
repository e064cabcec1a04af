#include "viewer/job_bars.h"

#include <algorithm>
#include <vector>

#include <imgui.h>

#include "viewer/widgets.h"

namespace fathom {

namespace {

// Of one key one may run while another waits: to the user they are one. The one that runs comes first.
std::vector<JobStatus> distinct_jobs(const Worker& worker) {
  std::vector<JobStatus> distinct;
  for (const JobStatus& job : worker.jobs()) {
    const auto same = [&](const JobStatus& other) { return other.key == job.key; };
    if (!job.cancelling && std::none_of(distinct.begin(), distinct.end(), same)) distinct.push_back(job);
  }
  return distinct;
}

void draw_bar(Session& session, const JobStatus& job, float width) {
  const ImVec2 low = ImGui::GetCursorScreenPos();
  ImGui::PushID(job.key.c_str());
  ImGui::ProgressBar(static_cast<float>(job.fraction), {6.0F * ui::em(), 1.2F * ui::em()}, "");
  ImGui::SameLine();
  ImGui::SmallButton("Cancel");
  // When pressed, not when let go: until then what is left of it may be done.
  if (ImGui::IsItemClicked()) session.cancel(job.key);
  ui::note_last("cancel:" + job.key);
  ImGui::SameLine();
  ImGui::PushClipRect(low, {low.x + width - ui::em(), low.y + 2.0F * ui::em()}, true);
  ImGui::TextUnformatted(job.title.c_str());
  ImGui::PopClipRect();
  ImGui::PopID();
}

}  // namespace

void JobBars::draw(Session& session) {
  const std::vector<JobStatus> jobs = distinct_jobs(session.worker());
  const auto find = [&](const std::string& key) {
    return std::find_if(jobs.begin(), jobs.end(), [&](const JobStatus& job) { return job.key == key; });
  };
  const auto is_free = [](const std::string& place) { return place.empty(); };
  for (std::string& place : places_) {
    if (find(place) == jobs.end()) place.clear();
  }
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const float whole = ImGui::GetContentRegionAvail().x;
  const bool pointed_at = ImGui::IsMouseHoveringRect(low, {low.x + whole, low.y + 1.6F * ui::em()});
  const bool may_fill = !pointed_at || std::all_of(places_.begin(), places_.end(), is_free);
  std::size_t hidden = 0;
  for (const JobStatus& job : jobs) {
    if (std::find(places_.begin(), places_.end(), job.key) != places_.end()) continue;
    const auto place = std::find_if(places_.begin(), places_.end(), is_free);
    if (may_fill && place != places_.end()) {
      *place = job.key;
    } else {
      ++hidden;
    }
  }
  const float width = std::min(22.0F * ui::em(), whole / static_cast<float>(kBars + 1));
  std::size_t used = 0;
  for (std::size_t i = 0; i < kBars; ++i) {
    if (places_[i].empty()) continue;
    ImGui::SetCursorScreenPos({low.x + static_cast<float>(i) * width, low.y});
    draw_bar(session, *find(places_[i]), width);
    used = i + 1;
  }
  ImGui::SetCursorScreenPos({low.x + static_cast<float>(used) * width, low.y});
  if (hidden == 0) return;
  ImGui::Text("and %zu more", hidden);
  ImGui::SameLine();
}

}  // namespace fathom
