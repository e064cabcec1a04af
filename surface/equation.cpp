#include "surface/equation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>
#include <string_view>
#include <vector>

#include <muParser.h>

#include "core/error.h"

namespace fathom {

namespace {

constexpr std::size_t kShownCharacters = 60;

struct Function {
  const char* name;
  double (*call)(double);
};

double sign(double value) { return value > 0.0 ? 1.0 : value < 0.0 ? -1.0 : 0.0; }

constexpr std::array kFunctions = {
    Function{"abs", std::fabs},    Function{"acos", std::acos}, Function{"asin", std::asin},
    Function{"atan", std::atan},   Function{"cbrt", std::cbrt}, Function{"ceil", std::ceil},
    Function{"cos", std::cos},     Function{"cosh", std::cosh}, Function{"exp", std::exp},
    Function{"floor", std::floor}, Function{"ln", std::log},    Function{"log", std::log},
    Function{"log10", std::log10}, Function{"log2", std::log2}, Function{"sign", sign},
    Function{"sin", std::sin},     Function{"sinh", std::sinh}, Function{"sqrt", std::sqrt},
    Function{"tan", std::tan},     Function{"tanh", std::tanh}};

double smallest(const double* values, int count) { return *std::min_element(values, values + count); }
double largest(const double* values, int count) { return *std::max_element(values, values + count); }
double arc_tangent(double y, double x) { return std::atan2(y, x); }

[[noreturn]] void fail(const std::string& expression, const std::string& what) {
  std::string shown = expression.substr(0, kShownCharacters);
  if (shown.size() < expression.size()) shown += "...";
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  throw Error("the equation '" + shown + "' " + what);
}

std::string at_character(std::size_t index) { return "at character " + std::to_string(index + 1); }

const std::string& what_is_known() {
  static const std::string text = "use x, y, z, numbers, pi, e and " + equation_functions();
  return text;
}

// The parser's own language is larger: it can assign to variables, handle text and give several results. What would
// lead there is refused before it sees the expression, and so is what would make it work without bound.
void require_plain(const std::string& expression) {
  constexpr std::string_view kKnown =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_. +-*/^()<>=!&|?:,\t";
  if (expression.find_first_not_of(" \t") == std::string::npos) {
    throw Error("the equation is empty; give an expression of x, y and z, such as \"x^2+y^2+z^2-1\"");
  }
  if (expression.size() > Equation::kLongest) {
    fail(expression, "is longer than " + std::to_string(Equation::kLongest) + " characters; shorten it");
  }
  int depth = 0;
  for (std::size_t i = 0; i < expression.size(); ++i) {
    const char c = expression[i];
    const char before = i > 0 ? expression[i - 1] : ' ';
    const char after = i + 1 < expression.size() ? expression[i + 1] : ' ';
    if (kKnown.find(c) == std::string_view::npos) {
      fail(expression, "has a sign that means nothing here, " + at_character(i) + "; " + what_is_known());
    }
    if (c == '(' && ++depth > Equation::kDeepest) {
      fail(expression,
           "has more than " + std::to_string(Equation::kDeepest) + " brackets within each other; simplify it");
    }
    if (c == ')') --depth;
    if (c == ',' && depth <= 0) {
      fail(expression, "has a comma outside of a function's brackets, " + at_character(i) +
                           "; give one expression, with points in decimal numbers");
    }
    const bool compares = after == '=' || before == '=' || before == '<' || before == '>' || before == '!';
    if (c == '=' && !compares) {
      fail(expression, "has a single =, " + at_character(i) +
                           "; give one side of the equation, the other being 0, and compare by ==");
    }
  }
}

[[noreturn]] void fail_as_parser_says(const std::string& expression, const mu::ParserError& error) {
  const std::string place = error.GetPos() >= 0 && static_cast<std::size_t>(error.GetPos()) < expression.size()
                                ? at_character(static_cast<std::size_t>(error.GetPos()))
                                : "at its end";
  const std::string token = error.GetToken().substr(0, kShownCharacters);
  switch (error.GetCode()) {
    case mu::ecUNASSIGNABLE_TOKEN:
      fail(expression, "names something unknown, '" + token + "', " + place + "; " + what_is_known());
    case mu::ecMISSING_PARENS:
    case mu::ecUNEXPECTED_PARENS:
      fail(expression, "has brackets that do not match, " + place + "; mend it");
    case mu::ecUNEXPECTED_EOF:
      fail(expression, "ends too early; complete it");
    case mu::ecTOO_FEW_PARAMS:
    case mu::ecTOO_MANY_PARAMS:
      fail(expression, "gives a function the wrong number of arguments, " + place + "; " + what_is_known());
    case mu::ecUNEXPECTED_VAR:
    case mu::ecUNEXPECTED_VAL:
    case mu::ecUNEXPECTED_FUN:
      fail(expression, "has '" + token + "' where an operator is due, " + place + "; write products as 2*x");
    default:
      fail(expression, "cannot be understood, " + place + (token.empty() ? "" : " ('" + token + "')") + "; mend it");
  }
}

// An expression with the variables that it reads.
class Parser {
 public:
  explicit Parser(const std::string& expression) {
    parser_.ClearFun();
    parser_.ClearConst();
    for (const Function& function : kFunctions) parser_.DefineFun(function.name, function.call);
    parser_.DefineFun("atan2", arc_tangent);
    parser_.DefineFun("min", smallest);
    parser_.DefineFun("max", largest);
    parser_.DefineConst("pi", std::numbers::pi);
    parser_.DefineConst("e", std::numbers::e);
    parser_.DefineVar("x", &place_[0]);
    parser_.DefineVar("y", &place_[1]);
    parser_.DefineVar("z", &place_[2]);
    parser_.SetExpr(expression);
    parser_.Eval();  // parses
  }
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  double value(const Eigen::Vector3d& place) {
    place_ = place;
    return parser_.Eval();
  }
  int results() const { return parser_.GetNumResults(); }

 private:
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();
  mu::Parser parser_;
};

}  // namespace

// Evaluating changes a parser, so each thread borrows one of its own.
class Equation::Parsers {
 public:
  explicit Parsers(const std::string& expression) : expression_(expression) {
    give_back(std::make_unique<Parser>(expression));
  }

  std::unique_ptr<Parser> borrow() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Parser> parser = std::move(idle_.back());
        idle_.pop_back();
        return parser;
      }
    }
    return std::make_unique<Parser>(expression_);
  }

  void give_back(std::unique_ptr<Parser> parser) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(parser));
  }

 private:
  std::string expression_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Parser>> idle_;
};

Equation::Equation(const std::string& expression) {
  require_plain(expression);
  try {
    parsers_ = std::make_unique<Parsers>(expression);
  } catch (const mu::ParserError& error) {
    fail_as_parser_says(expression, error);
  }
  std::unique_ptr<Parser> parser = parsers_->borrow();
  if (parser->results() != 1) fail(expression, "has more than one result; give one expression");
  parsers_->give_back(std::move(parser));
}

Equation::~Equation() = default;
Equation::Equation(Equation&&) noexcept = default;
Equation& Equation::operator=(Equation&&) noexcept = default;

void Equation::values(const Eigen::Vector3d& start, const Eigen::Vector3d& step, std::span<double> out) const {
  std::unique_ptr<Parser> parser = parsers_->borrow();
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = parser->value(start + static_cast<double>(i) * step);
  parsers_->give_back(std::move(parser));
}

double Equation::value(const Eigen::Vector3d& place) const {
  double value = 0.0;
  values(place, Eigen::Vector3d::Zero(), {&value, 1});
  return value;
}

const std::string& equation_functions() {
  static const std::string text = [] {
    std::string names;
    for (const Function& function : kFunctions) names += std::string(function.name) + " ";
    return names + "atan2(y, x) min(a, b, ...) max(a, b, ...)";
  }();
  return text;
}

}  // namespace fathom
