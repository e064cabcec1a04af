#include "viewer/application.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "core/text_file.h"
#include "exam/state_folder.h"
#include "viewer/gl.h"
#include "viewer/script.h"
#include "viewer/widgets.h"

namespace fathom {

namespace {

constexpr double kIdleWait_s = 0.5;   // nothing happens: ten times longer than anybody would notice in a bar
constexpr double kBusyWait_s = 0.02;  // work is under way

std::unique_ptr<Window> make_window(const Settings& settings, const Script* script) {
  WindowOptions options;
  options.width = script ? script->width() : settings.width;
  options.height = script ? script->height() : settings.height;
  options.dark = settings.dark;
  options.scale = settings.scale;
  options.scripted = script != nullptr;
  return std::make_unique<Window>(options);
}

}  // namespace

Application::Application(const ViewerOptions& options)
    : settings_(read_settings(settings_file())),
      script_(options.script.empty() ? nullptr : std::make_unique<Script>(options.script)),
      window_(make_window(settings_, script_.get())),
      session_([] { Window::wake(); }),
      live_([] { Window::wake(); }) {
  make_recent_actions();
  session_.on_opened = [this](const std::filesystem::path& path) {
    remember_recent(path);
    make_recent_actions();
  };
  if (!options.open.empty()) {
    DocumentOptions document;
    document.calibration = options.calibration;
    document.contours = options.contours;
    session_.open(options.open, document);
  }
}

Application::~Application() = default;

void Application::run() {
  while (!done_) {
    const bool waits = script_ == nullptr && frames_to_draw_ <= 0 && !window_->has_input();
    window_->wait(waits ? (session_.busy() || live_.live().connected() ? kBusyWait_s : kIdleWait_s) : 0.0);
    if (window_->has_input()) frames_to_draw_ = 3;
    if (script_ && !run_script()) break;
    frame();
    --frames_to_draw_;
    if (window_->close_asked()) close_or_ask();
  }
  const cv::Size size = window_->size();
  if (script_ == nullptr && !size.empty()) {
    settings_.width = size.width;
    settings_.height = size.height;
  }
  write_settings(settings_, settings_file());
}

bool Application::run_script() {
  ScriptTarget target;
  target.find = [this](const ScriptPoint& point) { return find(point); };
  target.push = [this](InputEvent event) { window_->push(std::move(event)); };
  target.busy = [this] { return busy(); };
  target.queued = [this] { return window_->has_input(); };
  target.picture = [this](const std::filesystem::path& file, const std::string& item) { write_picture(file, item); };
  target.dump = [this](const std::filesystem::path& file) { write_state(file); };
  target.keys = [this](const std::filesystem::path& file) { write_text_file(file, keys_markdown(actions_)); };
  target.bench = [this](const std::filesystem::path& file, int frames) { write_bench(file, frames); };
  return script_->step(target);
}

bool Application::busy() const { return session_.busy() || window_->has_input() || !review_.settled(session_); }

std::optional<Eigen::Vector2d> Application::find(const ScriptPoint& point) const {
  switch (point.kind) {
    case ScriptPoint::Kind::kWindow:
      return Eigen::Vector2d(point.at.head<2>());
    case ScriptPoint::Kind::kImage:
      return review_.find(point.at.head<2>());
    case ScriptPoint::Kind::kSpace:
      return outline_.find(point.at);
    case ScriptPoint::Kind::kItem:
      break;
  }
  const auto found = ui::places().items.find(point.item);
  if (found == ui::places().items.end()) return std::nullopt;
  const Places::Area& area = found->second;
  return Eigen::Vector2d(
      static_cast<double>(area.low.x) + point.at.x() * static_cast<double>(area.high.x - area.low.x),
      static_cast<double>(area.low.y) + point.at.y() * static_cast<double>(area.high.y - area.low.y));
}

void Application::frame() {
  if (std::exchange(look_changed_, false)) apply_look();
  session_.poll();
  window_->begin_frame();
  ui::new_frame();
  take_dropped();
  handle_keys(actions_);
  draw_panes();
  draw_messages();
  draw_help(actions_, help_);
  files_.draw();
  draw_recover_question();
  draw_close_question();
  window_->end_frame();
}

void Application::take_dropped() {
  for (const std::string& path : window_->take_dropped()) open_dropped(path);
}

void Application::open_dropped(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  const bool is_calibration = (extension == ".json" || extension == ".xml") && path.filename() != "exam.json";
  if (is_calibration && session_.document() != nullptr) {
    session_.attempt(path.filename().string(), [&] { session_.document()->set_calibration(path); });
  } else {
    session_.open(path);
  }
}

void Application::make_recent_actions() {
  actions_ = make_actions(*this);
  std::vector<Action> recent;
  for (const std::filesystem::path& path : recent_files()) {
    Action action;
    action.menu = kRecentMenu;
    action.label = path.string();
    action.run = [this, path] { session_.open(path); };
    recent.push_back(std::move(action));
  }
  const auto behind_file =
      std::find_if(actions_.begin(), actions_.end(), [](const Action& action) { return action.menu != "File"; });
  actions_.insert(behind_file, std::make_move_iterator(recent.begin()), std::make_move_iterator(recent.end()));
}

void Application::show_live(bool on) {
  live_shown_ = on;
  frames_to_draw_ = 3;
}

void Application::write_picture(const std::filesystem::path& file, const std::string& item) const {
  std::optional<cv::Rect> area;
  if (!item.empty()) {
    const auto found = ui::places().items.find(item);
    if (found == ui::places().items.end()) throw Error(file.string() + ": '" + item + "' is not shown");
    const auto low = cv::Point2f(found->second.low.x, found->second.low.y);
    const auto high = cv::Point2f(found->second.high.x, found->second.high.y);
    area = cv::Rect(cv::Point(low), cv::Point(high));
  }
  const cv::Mat picture = window_->picture(area);
  if (picture.empty()) throw Error(file.string() + ": there is nothing to take a picture of; enlarge the window");
  std::vector<unsigned char> bytes;
  if (!cv::imencode(file.extension().string(), picture, bytes)) {
    throw Error(file.string() + ": is no kind of picture that can be written; name it .png");
  }
  write_text_file(file, std::string(bytes.begin(), bytes.end()));
}

void Application::write_state(const std::filesystem::path& file) const {
  write_text_file(file, state_json(session_, reslice_.views(), live_.live(), settings_));
}

// What a frame of the interface costs the main thread, without what the driver draws: a driver without a graphics card
// draws in the thread that asks for it.
void Application::write_bench(const std::filesystem::path& file, int frames) {
  using Clock = std::chrono::steady_clock;
  const auto draw = std::exchange(gl::DrawArrays, [](GLenum, GLint, GLsizei) {});
  std::vector<double> milliseconds;
  for (int i = 0; i < frames; ++i) {
    const auto start = Clock::now();
    session_.poll();
    window_->begin_frame();
    ui::new_frame();
    handle_keys(actions_);
    draw_panes();
    ImGui::Render();
    milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    window_->end_frame();
    session_.show_frame((session_.view.frame + 1) % std::max(session_.frame_count(), 1));
  }
  gl::DrawArrays = draw;
  std::sort(milliseconds.begin(), milliseconds.end());
  double sum = 0.0;
  for (const double ms : milliseconds) sum += ms;
  const nlohmann::ordered_json json{{"frames", frames},
                                    {"mean_ms", sum / frames},
                                    {"median_ms", milliseconds[milliseconds.size() / 2]},
                                    {"p95_ms", milliseconds[milliseconds.size() * 95 / 100]},
                                    {"largest_ms", milliseconds.back()}};
  write_text_file(file, json.dump(1) + "\n");
}

void Application::apply_look() {
  window_->set_look(settings_.dark, settings_.scale > 0.0F ? settings_.scale : window_->display_scale());
}

void Application::save() {
  Document* document = session_.document();
  if (document == nullptr) return;
  if (!document->has_folder()) return ask_save_as();
  session_.save();
}

void Application::ask_save_as() {
  if (session_.document() == nullptr) return;
  files_.ask("Save as", "Save", "exam", [this](const std::filesystem::path& folder) { session_.save_as(folder); });
}

void Application::close_or_ask() {
  window_->refuse_close();
  const Document* document = session_.document();
  if (document != nullptr && document->is_modified() && !asks_to_close_) {
    asks_to_close_ = true;
  } else {
    done_ = true;
  }
}

void run_viewer(const ViewerOptions& options) { Application(options).run(); }

}  // namespace fathom
