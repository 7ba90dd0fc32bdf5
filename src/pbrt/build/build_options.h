#pragma once
#include <optional>
#include <string>

#include "pbrt/films/film_frame.h"

namespace pbrt {

struct BuildOptions {
    FilmOverrides film;
    int samplesPerPixel = 0;  ///< --spp; 0: the scene's
    std::optional<int> seed;  ///< --seed
    bool quick = false;       ///< a quarter of the resolution; one sample unless samplesPerPixel is set
    bool ignoreMedia = false, ignoreUnsupported = false;  ///< replace unsupported features, with warnings
    bool checksOutput = false;                        ///< error before building if the film's file cannot be written
    std::string integrator;                           ///< --integrator name; empty: the scene's
    std::optional<int> maxDepth;                      ///< --maxdepth
    bool sampledLightOnly = false;                    ///< PathSettings::sampledLightOnly (path, volpath)
    bool guide = false;                               ///< --guide
    std::string lightSampler;                         ///< --lightsampler, see LightFlags; empty: the scene's
    bool meshLights = false;                          ///< --mesh-lights
    std::string shootingSampler;                      ///< --shooting-sampler name[:key=value,...]; empty: the scene's
    const char *lightSamplerFlag = "--lightsampler";  ///< flag that set lightSampler, for messages
    std::optional<Float> displacementEdgeScale;       ///< --displacement-edge-scale; empty: the scene's or 1
    std::string renderCoordSys;                       ///< camera, cameraworld, world; empty: the scene's or cameraworld
    bool disableTextureFiltering = false;
    bool forceDiffuse = false;  ///< --force-diffuse
    int textureCacheMb = 0;     ///< --texture-cache-mb; 0: all images in memory
    bool disablePixelJitter = false, disableWavelengthJitter = false;
    std::string mseReferenceImage, mseReferenceOut;  ///< empty: the scene's Option, if any
};

}  // namespace pbrt
