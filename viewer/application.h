#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/actions.h"
#include "viewer/file_dialog.h"
#include "viewer/job_bars.h"
#include "viewer/live_pane.h"
#include "viewer/measurements_pane.h"
#include "viewer/outline_pane.h"
#include "viewer/reslice_pane.h"
#include "viewer/review_pane.h"
#include "viewer/session.h"
#include "viewer/settings.h"
#include "viewer/viewer.h"
#include "viewer/window.h"

namespace fathom {

class Script;
struct ScriptPoint;

/// The program: one window with its panes over one session.
class Application {
 public:
  /// Throws Error as Window and Script do.
  explicit Application(const ViewerOptions& options);
  ~Application();

  /// Until the window is closed or the script ends. Throws Error where the script fails.
  void run();

 private:
  friend std::vector<Action> make_actions(Application& application);

  void frame();
  bool run_script();
  void draw_menu_bar();
  void draw_toolbar();
  void draw_panes();
  void draw_right_side(ImVec2 low, ImVec2 size);
  void draw_first_steps(const char* pane);
  void draw_status();
  void draw_messages();
  void draw_close_question();
  void draw_recover_question();
  void make_recent_actions();
  void show_live(bool on);
  void take_dropped();
  void close_or_ask();
  std::optional<Eigen::Vector2d> find(const ScriptPoint& point) const;
  bool busy() const;
  void write_picture(const std::filesystem::path& file, const std::string& item) const;
  void write_state(const std::filesystem::path& file) const;
  void write_bench(const std::filesystem::path& file, int frames);

  void open_dropped(const std::filesystem::path& path);
  void save();
  void ask_save_as();
  void apply_look();

  Settings settings_;
  std::unique_ptr<Script> script_;
  std::unique_ptr<Window> window_;
  Session session_;
  ReviewPane review_;
  OutlinePane outline_;
  ReslicePane reslice_;
  LivePane live_;
  MeasurementsPane measurements_;
  FileDialog files_;
  JobBars bars_;
  std::vector<Action> actions_;
  bool help_ = false;
  bool live_shown_ = false;  // instead of Review
  bool asks_to_close_ = false;
  bool done_ = false;
  bool look_changed_ = false;  // fonts cannot change within a frame
  int frames_to_draw_ = 3;     // what one frame changes, the next ones show
};

/// The table of all actions, whose functions refer to `application`.
std::vector<Action> make_actions(Application& application);

/// The state of the model as a script's `dump` writes it: a JSON text.
std::string state_json(const Session& session, const ResliceViews& reslices, const LiveView& live,
                       const Settings& settings);

}  // namespace fathom
