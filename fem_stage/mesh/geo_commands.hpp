// A geometry is a program: gmsh's language can start other programs and write files. A case that comes from elsewhere
// must not, so its text is read for such commands before gmsh sees it.
#pragma once

#include <filesystem>

namespace tailrun::fem {

// Throws InputError (file, line, command) when the geometry, or a file that it includes or merges, has a command that
// starts programs, writes files, or hides text from this check. "Exit" is not among them: it ends gmsh, not the
// program.
void refuse_commands(const std::filesystem::path& geometry);

}  // namespace tailrun::fem
