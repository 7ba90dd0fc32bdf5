#pragma once
#include <memory>
#include <nlohmann/json_fwd.hpp>

#include "pbrt/films/film.h"

namespace pbrt {

/// Everything besides the sums that determines a film's image, so that it can be made without the scene.
struct FilmRecipe {
    std::string type;
    ParamSet params;
    std::string colorSpace = "srgb";
    Float exposureTime = 1;  ///< seconds
    FilmOverrides overrides;

    /// Creates an empty film that makes the same image of the same sums; samples cannot be added.
    std::unique_ptr<Film> Make() const;
    nlohmann::ordered_json ToJson() const;
    /// Throws UserError or an exception of the JSON library for input not from ToJson.
    static FilmRecipe FromJson(const nlohmann::ordered_json &json);
};

/// Floats are stored as bits, because JSON lacks infinity and full precision.
nlohmann::ordered_json ToJson(const ImageMetadata &metadata);
/// Attributes only.
ImageMetadata MetadataFromJson(const nlohmann::ordered_json &json);

}  // namespace pbrt
