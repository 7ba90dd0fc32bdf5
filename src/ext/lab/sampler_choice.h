#pragma once
#include <string>
#include <vector>

#include "pbrt/integrators/registry.h"

namespace ext::lab {
using namespace pbrt;

/// The flag that messages about a choice name.
inline constexpr const char *kSamplersFlag = "--samplers";

/// One competitor: kLightChoiceSyntax.
struct SamplerChoice {
    std::string label;         ///< as the user wrote it
    std::string folder;        ///< the label made safe for a file name
    std::string name;          ///< of the light sampler
    std::string lightSampler;  ///< name[:key=value,...][+guide[:key=value,...]]
    bool meshLights = false;
    bool IsOracle() const { return name == "oracle"; }
};

/// Splits a list of samplers. A semicolon ends a sampler, and so does a comma unless a "key=value" follows, which
/// belongs to the sampler before it: "octree:budget=0.02,floor=0.2,bvh" is two samplers.
std::vector<std::string> SplitSamplerList(const std::string &text);
/// Reads a file with one sampler per line; blank lines and text after # are ignored. Throws UserError if the file
/// cannot be read or names no sampler.
std::vector<std::string> ReadSamplerFile(const std::string &path);

/// Throws one UserError that lists all unknown names and parameters, wrong values and duplicates.
std::vector<SamplerChoice> ParseSamplerChoices(const std::vector<std::string> &texts, const PluginRegistry &registry);

/// Replaces all characters but letters, digits and -+=., by _.
std::string SafeFileName(const std::string &text);

}  // namespace ext::lab
