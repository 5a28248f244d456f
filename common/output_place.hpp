// Where results go. A place that cannot take them is wrong input and is said before the computation, not after it; what
// is there and is no regular file (a device, a folder, a pipe) is never replaced.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tailrun {

// Throws InputError when `path` is empty, exists and is no regular file, or lies in a folder that cannot be made or
// written to. Makes the folder; leaves the file as it is.
void check_output_file(const std::filesystem::path& path);

// The same, and when `path` is one of the `inputs` (those that are empty do not count), under whatever name.
void check_output_file(const std::filesystem::path& path, const std::vector<std::filesystem::path>& inputs);

// Throws InputError when `path` is `input`, under whatever name.
void require_no_input(const std::filesystem::path& path, const std::filesystem::path& input);

// Throws InputError when one of the `inputs` is one of the files `names` in `folder`, which are about to be written.
void require_results_apart(const std::filesystem::path& folder, const std::vector<std::string>& names,
                           const std::vector<std::filesystem::path>& inputs);

// Throws InputError when `path` exists and is no regular file: what every writer asks for right before it writes.
void require_replaceable(const std::filesystem::path& path);

// Throws InputError when `folder` is empty or cannot be made or written to, ComputationError when there is no space
// left there. Makes it.
void check_output_folder(const std::filesystem::path& folder);

// The name under which a file is written until it is complete: with the number of this process, so that two that write
// to one folder do not write into each other's.
std::filesystem::path temporary_name(const std::filesystem::path& path);

// What the system says about `error`, without the words of the file-system library.
std::string words_for(const std::filesystem::filesystem_error& error);

}  // namespace tailrun
