#include "acquisition/live/polhemus_setup.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <vector>

#include "acquisition/live/live_source.h"
#include "core/error.h"

namespace fathom {

namespace {

// The instruments answer within some 20 ms; adapters hold bytes back for up to 16 ms.
constexpr double kSilence_s = 0.08;
constexpr double kAnswer_s = 1.0;       // the longest wait for an answer that must come
constexpr double kFirstRecord_s = 2.0;  // some filters settle first
constexpr double kStop_s = 3.0;         // for an instrument to fall silent
constexpr std::size_t kLongestAnswer = 4096;

const char kWhoAreYou[] = "\x16\r";  // control-V

class Setup {
 public:
  Setup(PolhemusLine& line, const std::string& name, bool text, const std::stop_token& stop)
      : line_(line), name_(name), stop_(stop) {
    format_.text = text;
  }

  PolhemusFormat run() {
    line_.set_streaming(false);
    const auto model = line_.model();
    silence(model);
    format_.model = model ? *model : identify();
    if (format_.model == PolhemusModel::kFastrak) {
      set_up_fastrak();
    } else {
      set_up_tagged();
    }
    line_.set_streaming(true);
    wait_for_record();
    return format_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(name_ + ": " + what); }

  // What comes until the line has been silent, or for `longest_s`; of that as much as an answer can be.
  std::string listen(double first_s, double longest_s) {
    std::string heard;
    std::array<std::uint8_t, 256> bytes;
    const double end_s = live_clock_s() + longest_s;
    double wait_s = first_s;
    while (live_clock_s() < end_s) {
      if (stop_.stop_requested()) fail("stopped while it was being set up");
      const std::size_t count = line_.read(bytes, wait_s);
      if (count == 0) break;
      if (heard.size() < kLongestAnswer) {
        heard.append(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
      }
      wait_s = kSilence_s;
    }
    return heard;
  }

  // The answer to a command that has one.
  std::string ask(std::string_view command) {
    line_.write(command);
    return listen(kAnswer_s, 2.0 * kAnswer_s);
  }

  // What a command that has no answer but an error says.
  std::string tell(std::string_view command) {
    line_.write(command);
    return listen(kSilence_s, kAnswer_s);
  }

  // Ends an unfinished command and the sending of records, of whatever kind the instrument is.
  void silence(std::optional<PolhemusModel> model) {
    constexpr double kGoesOn_s = 0.5;  // a record or a complaint is an answer; what lasts this long is a stream
    const double end_s = live_clock_s() + kStop_s;
    while (live_clock_s() < end_s) {
      line_.write("\r");
      if (!model || *model != PolhemusModel::kFastrak) line_.write("P");
      if (!model || *model == PolhemusModel::kFastrak) line_.write("c");
      const double begin_s = live_clock_s();
      listen(kSilence_s, kGoesOn_s);
      if (live_clock_s() - begin_s < kGoesOn_s) return;
    }
    fail("does not stop sending; switch the instrument off and on");
  }

  // "2", station, "S", flags in 3 hexadecimal digits; empty where there is no such record.
  static std::optional<int> fastrak_flags(const std::string& answer) {
    for (std::size_t i = 0; i + 6 <= answer.size(); ++i) {
      int flags = 0;
      const char* digits = answer.data() + i + 3;
      if (answer[i] == '2' && answer[i + 2] == 'S' &&
          std::from_chars(digits, digits + 3, flags, 16).ptr == digits + 3) {
        return flags;
      }
    }
    return std::nullopt;
  }

  PolhemusModel identify() {
    // The others take this for a bad command, and complain at once.
    if (fastrak_flags(ask("FS\r"))) return PolhemusModel::kFastrak;
    std::string answer = ask(kWhoAreYou);
    for (char& c : answer) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    for (const PolhemusModel model : {PolhemusModel::kPatriot, PolhemusModel::kLiberty}) {
      if (answer.find(name_of(model)) != std::string::npos) return model;
    }
    fail("nothing answers as a FASTRAK, PATRIOT or LIBERTY; check that the instrument is on, the cable, and the rate " +
         std::string("(?baud=)"));
  }

  void set_up_fastrak() {
    tell("Fu");  // text, centimetres
    for (int station = 1; station <= most_stations(format_.model); ++station) {
      const std::string list = format_.text ? ",52,61,1\r" : ",2,11,1\r";
      const bool refused = tell("O" + std::to_string(station) + list).find("ERROR") != std::string::npos;
      if (refused && station == 1) fail("FASTRAK: refuses the list of what it is to send; switch it off and on");
    }
    constexpr int kBinary = 1, kCentimetres = 2;
    const auto flags = fastrak_flags(ask("S"));
    if (!flags) fail("FASTRAK: does not tell its state; check the cable and the rate (?baud=)");
    if ((*flags & kCentimetres) == 0 || (*flags & kBinary) != 0) {
      fail("FASTRAK: does not take centimetres; switch it off and on");
    }
    line_.write(format_.text ? "C" : "fC");
  }

  struct Answer {
    char command;
    int error;
    std::string content;
  };

  // The binary answers of a PATRIOT or LIBERTY among `bytes`.
  std::vector<Answer> answers(const std::string& bytes) const {
    const std::string preamble = format_.model == PolhemusModel::kPatriot ? "PA" : "LY";
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
    std::vector<Answer> found;
    for (std::size_t at = bytes.find(preamble); at != std::string::npos; at = bytes.find(preamble, at + 2)) {
      if (at + 8 > bytes.size()) break;
      const std::size_t size = byte(at + 6) + 256U * byte(at + 7);
      if (at + 8 + size > bytes.size()) continue;
      found.push_back({bytes[at + 3], byte(at + 4) == ' ' ? 0 : byte(at + 4), bytes.substr(at + 8, size)});
    }
    return found;
  }

  bool refuses(const std::string& command) {
    for (const Answer& answer : answers(tell(command))) {
      if (answer.command == command[0] && answer.error != 0) return true;
    }
    return false;
  }

  void set_up_tagged() {
    const std::string model = name_of(format_.model);
    // Binary first: its answers have one form.
    tell("F1\r");
    if (refuses("U1\r")) fail(model + ": does not take centimetres; switch it off and on");
    require_centimetres();
    // Clock, frame count, distortion, position, quaternion, a blank (as text: line end).
    const std::string rest = format_.text ? ",2,7,1\r" : ",2,7,0\r";
    format_.distortion = true;
    if (refuses("O*,8,9,11" + rest)) {
      format_.distortion = false;
      if (refuses("O*,8,9" + rest)) fail(model + ": refuses the list of what it is to send; switch it off and on");
    }
    line_.write(format_.text ? "F0\rC\r" : "C\r");
  }

  void require_centimetres() {
    const std::string model = name_of(format_.model);
    for (const Answer& answer : answers(ask("U\r"))) {
      if (answer.command != 'U' || answer.error != 0 || answer.content.empty()) continue;
      const bool rest_zero =
          std::all_of(answer.content.begin() + 1, answer.content.end(), [](char c) { return c == 0; });
      if (answer.content[0] == 1 && rest_zero) return;
      fail(model + ": does not take centimetres; switch it off and on");
    }
    fail(model + ": does not tell its units; check the cable and the rate (?baud=)");
  }

  void wait_for_record() {
    std::vector<std::uint8_t> waiting;
    std::array<std::uint8_t, 256> bytes;
    const double end_s = live_clock_s() + kFirstRecord_s;
    while (live_clock_s() < end_s) {
      if (stop_.stop_requested()) fail("stopped while it was being set up");
      const std::size_t count = line_.read(bytes, 0.1);
      waiting.insert(waiting.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
      for (PolhemusStep step = read_polhemus(waiting, format_); step.used > 0; step = read_polhemus(waiting, format_)) {
        if (step.reading) return;
        waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(step.used));
      }
    }
    fail(std::string(name_of(format_.model)) +
         ": sends no records of the form asked for; check that a sensor and the source are plugged in");
  }

  PolhemusLine& line_;
  const std::string& name_;
  const std::stop_token& stop_;
  PolhemusFormat format_;
};

}  // namespace

PolhemusFormat set_up_polhemus(PolhemusLine& line, const std::string& name, bool text, const std::stop_token& stop) {
  return Setup(line, name, text, stop).run();
}

void stop_polhemus(PolhemusLine& line, PolhemusModel model) {
  line.write(model == PolhemusModel::kFastrak ? "c" : "P");
}

}  // namespace fathom
