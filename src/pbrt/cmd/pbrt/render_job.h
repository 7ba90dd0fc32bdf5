#pragma once
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/core/progress.h"
#include "pbrt/lightsamplers/registry.h"

namespace pbrt {

/// Reads, builds, renders and writes one image. Throws UserError. Returns the exit status: 0, or 130 after Ctrl-C (what
/// was rendered is saved).
int RunRenderJob(const CommandLine &options, const LightSamplerRegistry &registry, Progress &progress);

}  // namespace pbrt
