#include "common/provenance.hpp"

#include <fmt/core.h>
#include <openssl/evp.h>

#include <fstream>
#include <sstream>

#include "common/error.hpp"

namespace tailrun {

std::string version() {
  return TAILRUN_VERSION;
}

std::string sha256_of_text(const std::string& text) {
  unsigned char sum[EVP_MAX_MD_SIZE];
  unsigned int length = 0;
  if (EVP_Digest(text.data(), text.size(), sum, &length, EVP_sha256(), nullptr) != 1)
    throw ComputationError("SHA-256 is not available in the OpenSSL library");
  std::string hexadecimal;
  for (unsigned int i = 0; i < length; ++i) hexadecimal += fmt::format("{:02x}", sum[i]);
  return hexadecimal;
}

std::string sha256_of_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: no such file, or it cannot be read", path.string()));
  std::ostringstream text;
  text << stream.rdbuf();
  return sha256_of_text(text.str());
}

void Provenance::add_text(const std::filesystem::path& path, const std::string& text) {
  inputs.push_back(path);
  texts.emplace_back(path.filename().string(), text);
  sha256.emplace_back(path.filename().string(), sha256_of_text(text));
}

void Provenance::add_file(const std::filesystem::path& path) {
  inputs.push_back(path);
  sha256.emplace_back(path.filename().string(), sha256_of_file(path));
}

void write_provenance(Hdf5Writer& file, const Provenance& provenance) {
  const std::string group = "/tailrun/provenance";
  file.group(group);
  file.attribute(group, "program", provenance.program);
  file.attribute(group, "version", version());
  std::vector<std::string> names, sums, text_names, texts;
  for (const auto& [name, sum] : provenance.sha256) {
    names.push_back(name);
    sums.push_back(sum);
  }
  for (const auto& [name, text] : provenance.texts) {
    text_names.push_back(name);
    texts.push_back(text);
  }
  file.write_texts(group + "/input_names", names, "files that were read");
  file.write_texts(group + "/input_sha256", sums, "SHA-256 of the files that were read");
  file.write_texts(group + "/case_names", text_names, "case files");
  file.write_texts(group + "/case_texts", texts, "the case files' full text");
}

}  // namespace tailrun
