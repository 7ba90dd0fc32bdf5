#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "fuzz/corpus.h"
#include "fuzz/mutators.h"
#include "fuzz/workplace.h"
#include "pbrt/core/state_io.h"
#include "pbrt/films/render_file.h"
#include "support/scene_text.h"

namespace pbrt::fuzz {

namespace {

namespace fs = std::filesystem;
constexpr size_t kMagicBytes = 12;  // and version

template <class T>
T ValueAt(std::string_view bytes, size_t at) {
    T value{};
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}
template <class T>
void Put(std::string &bytes, size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof(T));
}
/// The parts of a StateFile.
struct State {
    std::string magic, kind;
    std::vector<CaseFile> sections;

    explicit State(const std::string &file) {
        StateReader in(file, "state");
        magic = in.Take(kMagicBytes);
        in.Take(sizeof(uint64_t));  // its length
        kind = in.Text();
        for (auto count = in.Value<uint32_t>(); count > 0; --count) {
            const std::string name = in.Text();
            sections.push_back({name, in.Text()});
        }
    }
    /// As a file with its length and checksum.
    std::string Bytes() const {
        StateWriter out;
        out.Copy(magic.data(), magic.size());
        out(uint64_t{0}, kind, uint32_t(sections.size()));
        for (const CaseFile &section : sections) out(section.name, section.bytes);
        std::string bytes = out.Joined();
        const size_t summed = bytes.size();
        bytes.resize(summed + sizeof(uint64_t));
        Put(bytes, kMagicBytes, uint64_t{bytes.size()});
        Put(bytes, summed, uint64_t{crc32_z(0, reinterpret_cast<const Bytef *>(bytes.data()), summed)});
        return bytes;
    }
    std::string &Section(const std::string &name) {
        for (CaseFile &section : sections)
            if (section.name == name) return section.bytes;
        throw std::runtime_error("a state has no section " + name);
    }
};

/// Those that are not empty, found by their hashes.
std::vector<Structure> StructuresIn(std::string_view bytes) {
    std::vector<Structure> found;
    for (size_t at = 0; at + 2 * sizeof(uint64_t) <= bytes.size(); ++at) {
        const auto count = ValueAt<uint64_t>(bytes, at);
        const size_t left = bytes.size() - at - 2 * sizeof(uint64_t);
        for (const size_t size : {1, 4, 12}) {
            if (count == 0 || count > left / size) continue;
            const Structure s{at, count, size};
            if (StructureHash(bytes.substr(s.First(), count * size)) != ValueAt<uint64_t>(bytes, s.HashAt())) continue;
            found.push_back(s);
            at = s.End() - 1;
            break;
        }
    }
    return found;
}

/// Changes one word of four bytes to an extreme, a neighbouring or another value of the bytes.
void ChangeWord(std::string &bytes, size_t at, size_t other, Dice &dice) {
    static constexpr uint32_t kWords[] = {0,          1,          2,          0xffffffff, 0x7fffffff, 0x80000000,
                                          0x80000001, 0x7fc00000, 0x7f800000, 0xff800000, 0xbf800000, 0x00000001};
    const auto word = ValueAt<uint32_t>(bytes, at);
    switch (dice.Below(4)) {
        case 0: return Put(bytes, at, dice.Pick(kWords));
        case 1: return Put(bytes, at, word + 1);
        case 2: return Put(bytes, at, word - 1);
        default: {
            const auto swapped = ValueAt<uint32_t>(bytes, other);
            Put(bytes, other, word);
            Put(bytes, at, swapped);
        }
    }
}

/// Changes elements of a structure, or their number, and makes the hash fit.
void ChangeStructure(std::string &bytes, Structure s, Dice &dice) {
    const size_t words = s.count * s.size / sizeof(uint32_t);
    if (s.size == 1 || dice.OneIn(5)) {
        // An element less or one twice.
        const size_t element = s.First() + s.size * dice.Below(s.count);
        if (dice.OneIn(2)) {
            bytes.erase(element, s.size);
            --s.count;
        } else {
            bytes.insert(element, bytes.substr(element, s.size));
            ++s.count;
        }
        Put(bytes, s.at, uint64_t{s.count});
    } else {
        for (size_t changes = 1 + dice.Below(3); changes > 0; --changes)
            ChangeWord(bytes, s.First() + sizeof(uint32_t) * dice.Below(words),
                       s.First() + sizeof(uint32_t) * dice.Below(words), dice);
    }
    Put(bytes, s.HashAt(), StructureHash(std::string_view(bytes).substr(s.First(), s.count * s.size)));
}

/// Changes the content of a section. True: what it is must not be accepted.
bool ChangeSection(std::string &bytes, const std::vector<Structure> &structures, Dice &dice) {
    const std::string before = bytes;
    const size_t words = bytes.size() / sizeof(uint32_t);
    const size_t way = dice.Below(10);
    if (way < 4 && !structures.empty()) {
        ChangeStructure(bytes, dice.Pick(structures), dice);
        return false;
    }
    if (way < 8 && words > 0)
        ChangeWord(bytes, sizeof(uint32_t) * dice.Below(words), sizeof(uint32_t) * dice.Below(words), dice);
    else MutateBytes(bytes, 64, dice);
    if (bytes.size() != before.size()) return true;
    for (const Structure &s : structures)
        if (bytes.compare(s.at, s.End() - s.at, before, s.at, s.End() - s.at) != 0) return true;
    return false;
}

/// A room with a window.
std::string Room(const std::string &integrator, const std::string &lights, int width = 12, int height = 8) {
    return test::SceneText()
        .LookAt("0 1.2 -2.8  0 .8 0  0 1 0")
        .Camera(60)
        .Film(width, height)
        .Samples(16)
        .Integrator(integrator, 3)
        .World(test::Objects()
                   .Add(lights)
                   .Material("diffuse")
                   .Quad(test::room::kCeiling)
                   .Quad(test::room::kFloor)
                   .Quad(test::room::kBack)
                   .Quad(test::room::kRight)
                   .Quad(test::room::kFront)
                   .Quad("-3 0 -3  -3 0 3  -3 .8 -3  -3 .8 3")
                   .Quad("-3 1.6 -3  -3 1.6 3  -3 2 -3  -3 2 3"));
}

std::string Lamps(int count) {
    std::string text;
    for (int i = 0; i < count; ++i)
        text += fmt::format("LightSource \"point\" \"point3 from\" [ {} 1.9 {} ] \"rgb I\" [ .1 .2 .1 ]\n",
                            0.5 * (i % 10) - 2.5, 0.5 * (i / 10) - 2.2);
    return text;
}

const char *const kSky = "LightSource \"infinite\" \"string filename\" \"../assets/tiled.exr\"\n";
const char *const kFog =
    "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [ .2 .2 .2 ] \"rgb sigma_a\" [ .1 .1 .1 ]\n"
    "MediumInterface \"fog\" \"fog\"\nAttributeBegin\nMaterial \"interface\"\n"
    "Shape \"sphere\" \"float radius\" 20\nAttributeEnd\n";

struct Recipe {
    const char *name;
    std::string scene;
    std::vector<std::string> arguments;
    bool isCheckpoint;
    const char *samples = "--samples=0:3";  ///< of the checkpoint
};

std::vector<Recipe> Recipes() {
    const std::string few = Lamps(3), many = Lamps(80);
    return {{"lamps", Room("path", many), {"--lightsampler=octree+guide:leastsaved=0"}, true},
            {"few-lamps", Room("path", few), {"--lightsampler=octree+guide:leastsaved=0"}, true},
            {"windows", Room("path", kSky), {"--lightsampler=octree:portals=always"}, true},
            {"fog", Room("volpath", kFog + many), {"--lightsampler=octree+guide"}, true},
            {"bdpt", Room("bdpt", few), {"--lightsampler=octree"}, true},
            {"adaptive", Room("path", few), {"--lightsampler=bvh", "--adaptive"}, true, "--spp=12"},
            {"lights", Room("path", many), {"--lightsampler=octree+guide:leastsaved=0"}, false},
            {"lights-windows", Room("path", kSky), {"--lightsampler=octree:portals=always"}, false},
            {"lights-paper", Room("path", many), {"--lightsampler=octree:model=paper"}, false}};
}

/// The checkpoint of a part as that of a whole render, which resumes.
std::string OfWholeRender(const std::string &file) {
    State state(file);
    std::string &head = state.Section("head");
    RenderFileHead read;
    StateReader(head, "head").Structure(read);
    read.isPart = false;
    read.end = 16;
    StateWriter changed;
    changed.Structure(read);
    head = changed.Joined();
    return state.Bytes();
}

ChildResult RunHere(const FuzzCase &fuzzCase, const fs::path &folder) {
    std::ofstream(folder / "scene.pbrt") << fuzzCase.files.front().bytes;
    return RunChild(folder.string(),
                    [&](PictureReport &report) {
                        RunProgram(fuzzCase, report);
                        return 0;
                    },
                    {});
}

#ifdef PBRT_FUZZ_LIGHTLAB
StateSeed MakeReferenceSeed(const fs::path &work) {
    StateSeed seed{
        "reference",
        Room("path", Lamps(3), 32, 24),
        {},
        {"--nthreads=1", "--samplers=power", "--spp=2", "--seeds=2", "--reference-spp=16", "--selection-work=0"}};
    seed.isLightlab = true;
    FuzzCase making = UnchangedCase(seed);
    making.files.pop_back();
    const ChildResult made = RunHere(making, work);
    std::vector<fs::path> references;
    std::error_code isMissing;
    for (const auto &entry : fs::directory_iterator(work / kLabFolder, isMissing))
        if (entry.path().filename().string().starts_with("scene.reference-")) references.push_back(entry.path());
    if (references.empty()) throw std::runtime_error("no reference of lightlab: " + made.messages);
    const fs::path path = *std::min_element(references.begin(), references.end());
    seed.picture = ReadImage(path.string());
    seed.file = {path.filename().string(), TakeFile(path)};
    return seed;
}
#endif

/// The reference with other bytes, or another valid image.
FuzzCase MakeReferenceCase(const StateSeed &seed, Dice &dice) {
    FuzzCase made = UnchangedCase(seed);
    if (dice.OneIn(3)) {
        MutateAsset(made.files[1], dice);
        return made;
    }
    made.mustBeRefused = true;
    auto [image, metadata] = seed.picture;
    const Point2i size = image.Resolution();
    static constexpr const char *kTexts[] = {"lightlab.sampler", "lightlab.hash"},
                                *kCounts[] = {"lightlab.parts", "samplesPerPixel"};
    switch (dice.Below(5)) {
        case 0: {
            std::vector<std::string> channels = image.Channels();
            channels.erase(channels.begin() + dice.Below(channels.size()));
            image = image.Select(channels);
            break;
        }
        case 1:
            image = image.Crop({{0, 0}, {size.x, size.y - 1}});
            metadata.pixelBounds.reset();
            metadata.fullResolution.reset();
            break;
        case 2: metadata.attributes[dice.Pick(kTexts)] = std::string("bvh of others"); break;
        case 3: metadata.attributes[dice.Pick(kCounts)] = int(dice.Below(8)); break;
        default: {
            const Point2i p(int(dice.Below(size.x)), int(dice.Below(size.y)));
            const auto channel = int(dice.Below(image.Channels().size()));
            image.Set(p, channel, -1 - image.Get(p, channel));
        }
    }
    const fs::path path = fs::temp_directory_path() / fmt::format("pbrt-fuzz-{}.exr", getpid());
    WriteImage(path.string(), image, metadata);
    made.files[1].bytes = TakeFile(path);
    return made;
}

}  // namespace

FuzzCase UnchangedCase(const StateSeed &seed) {
    FuzzCase made{"state", seed.name, {{"scene.pbrt", seed.scene}, seed.file}, seed.arguments};
    made.isLightlab = seed.isLightlab;
    if (seed.isLightlab) made.output = std::string(kLabFolder) + "/reference-0.exr";
    return made;
}

std::vector<StateSeed> MakeStateSeeds(const std::string &folder) {
    std::vector<StateSeed> seeds;
    const fs::path work = fs::path(folder) / "states";
    fs::create_directories(work);
    for (const Recipe &recipe : Recipes()) {
        StateSeed seed{recipe.name, recipe.scene, {}, {"--nthreads=1"}};
        seed.arguments.insert(seed.arguments.end(), recipe.arguments.begin(), recipe.arguments.end());
        seed.file.name = recipe.isCheckpoint ? "state.chk" : "state.lights";
        FuzzCase making{"state", seed.name, {{"scene.pbrt", seed.scene}}, seed.arguments};
        making.arguments.push_back((recipe.isCheckpoint ? "--checkpoint=" : "--save-lights=") + seed.file.name);
        if (recipe.isCheckpoint) making.arguments.push_back(recipe.samples);
        const ChildResult made = RunHere(making, work);
        seed.file.bytes = TakeFile(work / seed.file.name);
        if (seed.file.bytes.empty()) throw std::runtime_error("no state of " + seed.name + ": " + made.messages);
        if (recipe.isCheckpoint) {
            seed.file.bytes = OfWholeRender(seed.file.bytes);
            seed.arguments.insert(seed.arguments.end(), {"--checkpoint=" + seed.file.name, "--resume"});
        } else {
            seed.arguments.push_back("--load-lights=" + seed.file.name);
        }
        for (const CaseFile &section : State(seed.file.bytes).sections)
            seed.structures[section.name] = StructuresIn(section.bytes);
        seeds.push_back(std::move(seed));
    }
#ifdef PBRT_FUZZ_LIGHTLAB
    seeds.push_back(MakeReferenceSeed(work));
#endif
    fs::remove_all(work);
    return seeds;
}

FuzzCase MakeStateCase(const StateSeed &seed, Dice &dice) {
    if (seed.isLightlab) return MakeReferenceCase(seed, dice);
    FuzzCase made = UnchangedCase(seed);
    State state(seed.file.bytes);
    CaseFile *section = &state.sections[dice.Below(state.sections.size())];
    if (dice.OneIn(30)) {
        if (dice.OneIn(2)) state.sections.push_back(*section);
        else state.sections.erase(state.sections.begin() + (section - state.sections.data()));
        made.mustBeRefused = true;
    } else {
        if (!dice.OneIn(4))
            for (CaseFile &other : state.sections)
                if (other.name == "learned") section = &other;
        made.mustBeRefused = ChangeSection(section->bytes, seed.structures.at(section->name), dice);
    }
    made.files[1].bytes = state.Bytes();
    return made;
}

}  // namespace pbrt::fuzz
