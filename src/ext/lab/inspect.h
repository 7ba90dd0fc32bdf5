#pragma once
#include <functional>
#include <string>
#include <vector>

#include "ext/lab/text_output.h"
#include "pbrt/build/built_scene.h"
#include "pbrt/images/image.h"

namespace ext::lab {
using namespace pbrt;

struct InspectSettings {
    int samples = 32;      ///< light samples and shadow rays per light and pixel
    int shownLights = 16;  ///< images of measured visibility, for the most powerful lights
    /// Limit on pixels x (lights + groups x samples). Above it only every n-th pixel per row and column is inspected
    /// and represents its neighbours.
    double maxWork = 5e8;
};

/// An image: one channel of Inspection::image.
struct InspectedLayer {
    std::string name, meaning;
    bool isId = false;                  ///< identifiers, shown as unordered colours
    bool ofScene = false;               ///< independent of the sampler
    double shownMin = 0, shownMax = 1;  ///< limits of the colour scale
    double min = 0, max = 0, mean = 0;  ///< of the finite values where "hit" is 1 (layer "hit": everywhere)
    size_t values = 0, unknown = 0;     ///< number of these finite values, and of non-finite ones
    std::string light{};                ///< light that the layer refers to; empty: none
    /// True if the value is constant or nowhere defined; the page then has a sentence instead of an image.
    bool IsFlat() const { return values == 0 || (min == max && unknown == 0); }
};

/// A light, or all primitives of an emissive mesh.
struct InspectedLight {
    LightId first{};
    size_t count = 1;  ///< lights of the table, contiguous
    double power = 0;
    std::string label;  ///< scene file location, from LightNames
};

struct Inspection {
    /// One float channel per layer, over the film's pixels. Layer "hit" is 1 where a surface that is not purely
    /// specular is visible, directly or through specular ones; other layers are 0 elsewhere.
    Image image;
    std::vector<InspectedLayer> layers;  ///< "hit" first
    std::vector<InspectedLight> lights;
    std::string structure;  ///< LightSampler::DescribeStructure
    int stride = 1;         ///< see InspectSettings::maxWork
};

/// Inspects a prepared light sampler at the first visible surfaces, with one ray per pixel centre. Deterministic.
/// Layers: values of LightSampler::Inspect; entropy of the pmf over lights; the strongest light and its probability;
/// second moment of the one-light estimator relative to the minimum; measured visibility of the strongest lights; of
/// the integrator, unless null, mean path vertices and the state of the path guide.
Inspection InspectLights(const BuiltScene &built, const LightSampler &sampler, const Integrator *integrator,
                         const InspectSettings &settings, Progress &progress);

/// Writes one false-colour PNG per non-flat layer that is `wanted` into `folder`, created if needed, by its name after
/// `prefix`, which may name a subfolder; `legendRows`: height of the colour bar in pixels. Returns per wanted layer:
/// name, file (from `folder`; null if flat), meaning, colour scale limits, range.
Json WriteLayers(const Inspection &inspection, const std::string &folder, const std::string &prefix, int legendRows,
                 const std::function<bool(const InspectedLayer &)> &wanted);

/// Writes inspect.exr (all layers), a false-colour PNG per non-flat layer, inspect.json (meanings and ranges),
/// index.html (overview) and structure.txt into `folder`, created if needed.
void WriteInspection(const Inspection &inspection, const std::string &folder, const Json &about);

struct InspectOptions {
    std::vector<std::string> sceneFiles;
    BuildOptions build;  ///< build.lightSampler: the inspected sampler; film overrides set the resolution
    InspectSettings settings;
    std::string outFolder;  ///< empty: "inspect-<sampler>" in the working directory
    std::string commandLine;
};

/// Builds the scene, prepares and inspects the sampler, writes the results, and prints structure and ranges to standard
/// output. Exit status: 0, or 130 if interrupted. Throws UserError.
int RunInspect(const InspectOptions &options, const PluginRegistry &registry, Progress &progress);

}  // namespace ext::lab
