// Writes the sample scene: generate_hall FOLDER. The same bytes on every run.

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include "samples/hall/gltf_writer.hpp"
#include "samples/hall/layout.hpp"
#include "samples/hall/sidecars.hpp"

int main(int argument_count, char** arguments) {
    using namespace tyndall::hall;
    const std::string_view argument = argument_count == 2 ? arguments[1] : "";
    const bool asks_for_help = argument == "--help" || argument == "-h";
    if (asks_for_help || argument.empty() || argument.front() == '-') {
        std::fputs("usage: generate_hall FOLDER (made when missing; the scene is FOLDER/hall.gltf)\n",
                   asks_for_help ? stdout : stderr);
        return asks_for_help ? 0 : 2;
    }
    const std::filesystem::path folder = arguments[1];
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure) {
        std::fprintf(stderr, "cannot make the folder %s: %s\n", folder.c_str(), failure.message().c_str());
        return 2;
    }
    Scene scene;
    const Materials materials = add_materials(scene);
    add_architecture(scene, materials);
    add_furniture(scene, materials);
    add_glasswork(scene, materials);
    add_lamps(scene, materials);
    add_sun_and_cameras(scene);
    const auto written = write_gltf(scene, folder, "hall")
                             .and_then([&] { return write_text(folder / "hall.fog.json", fog_json()); })
                             .and_then([&] { return write_text(folder / "hall.particles.json", particles_json()); });
    if (!written) {
        std::fprintf(stderr, "%s\n", written.error().c_str());
        return 2;
    }
    return 0;
}
