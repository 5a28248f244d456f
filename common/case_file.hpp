// Reading a case file (JSON). Every stage reads its options through CaseNode, which is the one validator: a key is
// known because somebody asked for it, has a type, a unit and a range, and whatever nobody asked for is an error that
// names the nearest known key. Errors are InputError and carry the file and the JSON pointer.
//
//   const CaseFile file("fem.json");
//   const CaseNode newmark = file.root().object("newmark");
//   const double dt = newmark.number("time_step", "s", Range::positive());
//   const double gamma = newmark.number_or("gamma", "1", Range::between(0.5, 1.5), 0.6);
//   file.finish();                       // throws on keys that nobody asked for
//   for (const auto& line : file.echo()) // "newmark/gamma = 0.6 [1] (default)"
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tailrun {

// An interval of admissible values; open ends exclude the bound itself.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;
  bool high_open = false;

  static Range any() { return {}; }
  static Range positive() { return {0.0, std::numeric_limits<double>::infinity(), true, false}; }
  static Range non_negative() { return {0.0, std::numeric_limits<double>::infinity(), false, false}; }
  static Range between(double low, double high) { return {low, high, false, false}; }
  static Range open(double low, double high) { return {low, high, true, true}; }
  bool contains(double value) const;
  std::string text() const;  // "(0, 1]"
};

class CaseNode;

class CaseFile {
 public:
  // Throws InputError when the file is missing, unreadable or not JSON (with line and column).
  explicit CaseFile(const std::filesystem::path& path);
  ~CaseFile();
  CaseFile(CaseFile&&) noexcept;

  CaseNode root() const;
  const std::filesystem::path& path() const;
  const std::string& text() const;  // the file as read, with --set's values
  void finish() const;              // throws InputError on the first key that nobody asked for
  // Every option read, a line each: pointer, value, unit, and at its end "(default)" or, of what the file says and is
  // not the default, "(default: <value>)".
  std::vector<std::string> echo() const;
  // The file itself and all files that it names and that were asked for (CaseNode::file): no result may take their
  // place.
  std::vector<std::filesystem::path> inputs() const;

 private:
  friend class CaseNode;
  struct State;
  std::shared_ptr<State> state_;
};

// A JSON object of the case file (or, for list elements of plain values, that value).
class CaseNode {
 public:
  double number(const std::string& key, std::string_view unit, Range range) const;
  double number_or(const std::string& key, std::string_view unit, Range range, double fallback) const;
  std::optional<double> number_if(const std::string& key, std::string_view unit, Range range) const;
  long integer(const std::string& key, long low, long high) const;
  long integer_or(const std::string& key, long low, long high, long fallback) const;
  bool boolean_or(const std::string& key, bool fallback) const;
  std::string text(const std::string& key) const;
  std::string text_or(const std::string& key, const std::string& fallback) const;
  std::string choice(const std::string& key, const std::vector<std::string>& allowed) const;
  std::string choice_or(const std::string& key, const std::vector<std::string>& allowed,
                        const std::string& fallback) const;
  // `count` 0 means any length.
  std::vector<double> numbers(const std::string& key, std::string_view unit, Range range, std::size_t count = 0) const;
  std::vector<double> numbers_or(const std::string& key, std::string_view unit, Range range,
                                 const std::vector<double>& fallback, std::size_t count = 0) const;
  std::vector<std::string> texts_or(const std::string& key, const std::vector<std::string>& fallback) const;
  // [[x, y], ...]: rows of `columns` numbers each, flattened row by row.
  std::vector<double> table(const std::string& key, std::string_view unit, std::size_t columns) const;
  // A path relative to the case file's folder; it must exist.
  std::filesystem::path file(const std::string& key) const;

  CaseNode object(const std::string& key) const;
  std::optional<CaseNode> object_if(const std::string& key) const;
  // An object whether it is there or not: reads of a missing one give every default.
  CaseNode object_or_empty(const std::string& key) const;
  std::vector<CaseNode> list(const std::string& key) const;           // of objects; required
  std::vector<CaseNode> list_or_empty(const std::string& key) const;  // of objects
  // The members of an object with free names (materials, regions ...), in the order of the file.
  std::vector<std::pair<std::string, CaseNode>> members() const;

  std::vector<std::string> keys() const;         // the keys that are there, in the order of the file
  bool has(const std::string& key) const;        // makes the key known
  bool is_number(const std::string& key) const;  // present and a number (for keys that take a number or a word)
  bool is_list(const std::string& key) const;
  const std::string& pointer() const { return pointer_; }
  // The number of `key` where there is one, without making the key known: for checks on what has been read.
  std::optional<double> peek(const std::string& key) const;
  // A warning (common/warnings.hpp) that names the file, this node's pointer plus `key`, and `message`.
  void warn(const std::string& key, const std::string& message) const;
  // An InputError that names the file, this node's pointer plus `key` (may be empty) and `message`.
  [[noreturn]] void fail(const std::string& key, const std::string& message) const;

 private:
  friend class CaseFile;
  CaseNode(std::shared_ptr<CaseFile::State> state, const nlohmann::ordered_json* json, std::string pointer);
  const nlohmann::ordered_json* find(const std::string& key) const;
  const nlohmann::ordered_json& require(const std::string& key, std::string_view wanted) const;
  double checked(const std::string& key, const nlohmann::ordered_json& value, std::string_view unit, Range range) const;
  // `fallback`: what holds without the key, for a key that may be absent.
  void record(const std::string& key, const std::string& value, std::string_view unit,
              const std::optional<std::string>& fallback = {}) const;
  long whole_number(const std::string& key, long low, long high) const;
  std::string plain_text(const std::string& key) const;
  std::string word_of(const std::string& key, const std::vector<std::string>& allowed) const;
  std::vector<double> list_of_numbers(const std::string& key, std::string_view unit, Range range,
                                      std::size_t count) const;
  std::vector<CaseNode> elements(const std::string& key, const nlohmann::ordered_json& value) const;

  std::shared_ptr<CaseFile::State> state_;
  const nlohmann::ordered_json* json_;  // null for an absent object
  std::string pointer_;
};

// What `--size` asks for is an entry of the object "sizes" in `node`, or "default", or empty. Throws InputError with
// the nearest entry; a node without sizes has one for all.
void require_size(const CaseNode& node, const std::string& size);

}  // namespace tailrun
