#pragma once
#include <string>
#include <vector>

#include "pbrt/lightsamplers/registry.h"

namespace pbrt::lab {

/// Where messages say that a choice was made.
inline constexpr const char *kSamplersFlag = "--samplers";

/// One competitor: name[:key=value,...][+mesh][+gate=name[:key=value,...]].
struct SamplerChoice {
    std::string label;         ///< as the user wrote it
    std::string folder;        ///< the label made safe for a file name
    std::string name;          ///< of the light sampler
    std::string lightSampler;  ///< name[:key=value,...]
    bool meshLights = false;
    std::string gate;  ///< name[:key=value,...]; empty: none of its own
    bool IsOracle() const { return name == "oracle"; }
};

/// Takes a list apart. A semicolon ends a sampler, and so does a comma unless a "key=value" follows, which belongs to
/// the sampler before: "octree:budget=0.02,floor=0.2,bvh" is two samplers.
std::vector<std::string> SplitSamplerList(const std::string &text);
/// One sampler a line; blank lines and what follows # are left out. Throws UserError if unreadable or empty.
std::vector<std::string> ReadSamplerFile(const std::string &path);

/// Unknown names and parameters, wrong values, duplicates: one UserError with all of them.
std::vector<SamplerChoice> ParseSamplerChoices(const std::vector<std::string> &texts,
                                               const LightSamplerRegistry &registry);

/// Letters, digits and -+=., stay; the rest becomes _.
std::string SafeFileName(const std::string &text);

}  // namespace pbrt::lab
