#pragma once
/// @file
/// What diagrams of speed against error share: processor time, observed orders, tables as CSV.

#include <concepts>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace lagrain::bench {

/// Processor time of this thread [s]; a shared machine takes the wall clock's time away.
double processor_seconds();

/// The middle value; NaN without any.
double median_of(std::vector<double> values);

/// Processor time of one call [s]: the median of three rounds, each of as many calls as fill
/// `least` seconds.
double seconds_per_call(const std::function<void()>& call, double least = 0.02);

/// Slope of the straight line through (log x, log y), by least squares: the order at which an error
/// y falls with a step x. Points that are not positive are left out; NaN with fewer than two.
double observed_order(std::span<const double> x, std::span<const double> y);

/// A table of numbers for a file. Numbers read back bit for bit, text is quoted, NaN leaves a cell
/// empty.
class Csv {
 public:
  /// @param head  names with units, "step[s],error[-]"
  explicit Csv(const std::string& head) : text_(head + "\n") {}

  template <class... Cells>
  void row(const Cells&... cells) {
    std::string line;
    ((line += (line.empty() ? "" : ",") + cell(cells)), ...);
    text_ += line + "\n";
  }
  const std::string& text() const { return text_; }

 private:
  static std::string cell(const std::string& text) { return "\"" + text + "\""; }
  static std::string cell(const char* text) { return cell(std::string(text)); }
  static std::string cell(double number);
  template <std::integral I>
  static std::string cell(I number) {
    return std::to_string(number);
  }

  std::string text_;
};

}  // namespace lagrain::bench
