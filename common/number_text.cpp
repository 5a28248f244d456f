#include "common/number_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace tailrun {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t start = line.find_first_not_of(" \t", i);
    if (start == std::string_view::npos) break;
    const std::size_t end = std::min(line.find_first_of(" \t", start), line.size());
    words.push_back(line.substr(start, end - start));
    i = end;
  }
  return words;
}

// Appends the numbers of a word that begin at signs. False when something else is in it.
bool take_word(std::string_view word, std::vector<double>& values) {
  while (!word.empty()) {
    std::size_t used = 0;
    const auto value = leading_number(word, used);
    if (!value) return false;
    values.push_back(*value);
    word.remove_prefix(used);
    if (!word.empty() && word.front() != '-' && word.front() != '+') return false;
  }
  return true;
}

// Every cell of a line in columns of `width`; nothing unless each is a number with a decimal point.
std::optional<std::vector<double>> columns_of_width(std::string_view line, std::size_t width) {
  std::vector<double> values;
  for (std::size_t i = 0; i < line.size(); i += width) {
    const std::string_view cell = trimmed(line.substr(i, width));
    const auto value = number_of(cell);
    if (!value || std::count(cell.begin(), cell.end(), '.') != 1) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

}  // namespace

std::optional<double> leading_number(std::string_view text, std::size_t& used) {
  used = 0;
  std::string plain;  // as from_chars wants it: no +, E for D
  std::size_t i = 0;
  if (i < text.size() && (text[i] == '+' || text[i] == '-')) {
    if (text[i] == '-') plain += '-';
    ++i;
  }
  std::size_t digits = 0;
  for (; i < text.size() && is_digit(text[i]); ++i, ++digits) plain += text[i];
  if (i < text.size() && text[i] == '.') {
    plain += text[i++];
    for (; i < text.size() && is_digit(text[i]); ++i, ++digits) plain += text[i];
  }
  if (digits == 0) return std::nullopt;
  if (i < text.size() && std::string_view("eEdD").find(text[i]) != std::string_view::npos) {
    std::size_t j = i + 1;
    std::string exponent = "e";
    if (j < text.size() && (text[j] == '+' || text[j] == '-')) exponent += text[j++];
    const std::size_t first = j;
    for (; j < text.size() && is_digit(text[j]); ++j) exponent += text[j];
    if (j > first) {
      plain += exponent;
      i = j;
    }
  }
  double value = 0.0;
  const auto result = std::from_chars(plain.data(), plain.data() + plain.size(), value);
  if (result.ec != std::errc() || result.ptr != plain.data() + plain.size() || !std::isfinite(value))
    return std::nullopt;
  used = i;
  return value;
}

std::optional<double> number_of(std::string_view word) {
  std::size_t used = 0;
  const auto value = leading_number(word, used);
  return value && used == word.size() ? value : std::nullopt;
}

std::optional<std::vector<double>> fortran_numbers(std::string_view line, std::string_view& bad) {
  std::vector<double> values;
  bool clean = true;
  for (const auto word : words_of(line)) {
    if (take_word(word, values)) continue;
    bad = word;
    clean = false;
    break;
  }
  if (clean) return values;
  while (!line.empty() && (line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
  std::optional<std::vector<double>> found;
  for (std::size_t width = 4; width <= 25 && width < line.size(); ++width) {
    if (line.size() % width != 0) continue;
    const auto cells = columns_of_width(line, width);
    if (!cells) continue;
    if (found) return std::nullopt;  // two widths fit: no telling
    found = cells;
  }
  return found;
}

}  // namespace tailrun
