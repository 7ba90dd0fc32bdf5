#pragma once
#include <string>
#include <vector>

#include "pbrt/integrators/registry.h"

namespace ext::lab {
using namespace pbrt;

/// Flag named in messages about a choice.
inline constexpr const char *kSamplersFlag = "--samplers";

/// A compared sampler: kLightChoiceSyntax.
struct SamplerChoice {
    std::string label;         ///< as typed
    std::string folder;        ///< the label as a safe file name
    std::string name;          ///< of the light sampler
    std::string lightSampler;  ///< name[:key=value,...][+guide[:key=value,...]]
    bool meshLights = false;
    bool IsOracle() const { return name == "oracle"; }
};

/// Splits a list of samplers. A semicolon ends a sampler, and so does a comma unless a "key=value" follows, which
/// belongs to the preceding sampler: "octree:budget=0.02,floor=0.2,bvh" is two samplers.
std::vector<std::string> SplitSamplerList(const std::string &text);
/// Reads a file with one sampler per line, ignoring blank lines and text after #. Throws UserError if it is unreadable
/// or names no sampler.
std::vector<std::string> ReadSamplerFile(const std::string &path);

/// Throws one UserError with all unknown names and parameters, invalid values and duplicates.
std::vector<SamplerChoice> ParseSamplerChoices(const std::vector<std::string> &texts, const PluginRegistry &registry);

/// Replaces all characters except letters, digits and -+=., by _.
std::string SafeFileName(const std::string &text);

}  // namespace ext::lab
