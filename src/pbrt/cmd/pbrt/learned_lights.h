#pragma once
#include <memory>
#include <nlohmann/json.hpp>

#include "pbrt/build/built_scene.h"
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/core/files.h"
#include "pbrt/core/state_file.h"
#include "pbrt/scenefile/content_hash.h"

namespace pbrt {

/// Files of --save-lights and --load-lights: light sampler records and a guide for other renders.
class LearnedLights {
  public:
    /// Reads the file to load. Throws UserError if it is damaged, or if the file to save is not writable.
    static LearnedLights Open(const CommandLine &options) {
        LearnedLights lights;
        lights.savePath_ = options.saveLights;
        if (!options.loadLights.empty()) lights.loaded_ = std::make_unique<StateFile>(options.loadLights, kKind);
        if (!lights.savePath_.empty()) CheckWritable(lights.savePath_);
        return lights;
    }

    bool AreUsed() const { return loaded_ || !savePath_.empty(); }
    bool AreLoaded() const { return loaded_ != nullptr; }
    /// Content hash of the loaded file; empty if none.
    std::string Hash() const {
        if (!loaded_) return {};
        ContentHash hash(std::string(loaded_->Section("identity")));
        hash.Add(std::string(loaded_->Section("learned")));
        return hash.Hex();
    }
    /// Checks that the sampler learns and that the loaded file matches the scene. Throws UserError.
    void Check(const BuiltScene &built) const {
        if (!AreUsed()) return;
        const char *flag = loaded_ ? "--load-lights" : "--save-lights";
        const LightSampler *lights = built.integrator->Lights();
        if (!lights) throw UserError("{}: the integrator \"{}\" uses no light sampler.", flag, built.integratorName);
        if (!lights->SavesLearned() && !built.integrator->Directions())
            throw UserError("{}: the light sampler \"{}\" learns nothing that could be saved.", flag,
                            built.lightSamplerName);
        if (!loaded_) return;
        RenderIdentity saved;
        StateReader in(loaded_->Section("identity"), loaded_->Path());
        in.Structure(saved);
        in.Require(in.Value<uint64_t>() == loaded_->Section("learned").size(), "it has another length");
        in.RequireEnd();
        if (const std::string differences = DifferencesOf(IdentityOf(built), saved, loaded_->Path());
            !differences.empty())
            throw UserError("{}: was learned for other lights: {}.", loaded_->Path(), differences);
    }
    StateReader Learned() const { return {loaded_->Section("learned"), loaded_->Path()}; }
    /// Writes the records after the render. Throws UserError.
    void Save(const BuiltScene &built) const {
        StateWriter identity, learned;
        built.integrator->SaveLearned(learned, false);
        identity.Structure(IdentityOf(built));
        identity.Value(learned.Bytes());
        WriteStateFile(savePath_, kKind, {{"identity", &identity}, {"learned", &learned}});
    }
    const std::string &SavePath() const { return savePath_; }

  private:
    using Json = nlohmann::ordered_json;
    static constexpr const char *kKind = "file of learned lights";
    LearnedLights() = default;
    static RenderIdentity IdentityOf(const BuiltScene &built) {
        Json report = Json::object();
        built.integrator->Lights()->Report(report);
        const auto it = report.find("parameters");
        const std::string parameters = it == report.end() ? "" : it->is_string() ? it->get<std::string>() : it->dump();
        return LightIdentity(*built.scene, built.lightSamplerName, parameters);
    }
    std::string savePath_;
    std::unique_ptr<StateFile> loaded_;
};

}  // namespace pbrt
