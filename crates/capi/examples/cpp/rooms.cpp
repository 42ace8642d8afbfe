// Two rooms with a door between them, in C++: owners, containers and exceptions.
#include <sightlines.hpp>

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <thread>

namespace {

void add_box(sightlines::scene &scene, const char *name, const sightlines::point &min, const sightlines::point &max,
             std::uint32_t flags = 0) {
    static const std::vector<std::uint32_t> indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                                       2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    std::vector<double> corners;
    for (unsigned i = 0; i < 8; ++i) {
        for (unsigned k = 0; k < 3; ++k) {
            corners.push_back((i >> k & 1u) != 0 ? max[k] : min[k]);
        }
    }
    scene.add(name, corners, indices, flags);
}

sightlines::scene rooms() {
    sightlines::scene scene;
    add_box(scene, "floor", {0, 0, -1}, {12, 6, 0});
    add_box(scene, "ceiling", {0, 0, 3}, {12, 6, 4});
    add_box(scene, "west", {-1, -1, -1}, {0, 7, 4});
    add_box(scene, "east", {12, -1, -1}, {13, 7, 4});
    add_box(scene, "south", {0, -1, -1}, {12, 0, 4});
    add_box(scene, "north", {0, 6, -1}, {12, 7, 4});
    add_box(scene, "wall/left", {6, 0, 0}, {6.5, 1, 3});
    add_box(scene, "wall/right", {6, 2, 0}, {6.5, 6, 3});
    add_box(scene, "door", {6.2, 1, 0}, {6.3, 2, 3}, SL_OBJECT_DOOR);
    add_box(scene, "chair", {2, 2, 0}, {2.5, 2.5, 1});
    add_box(scene, "table", {9, 1, 0}, {10, 2, 1});
    add_box(scene, "lamp", {7, 5, 0}, {7.3, 5.3, 2});
    return scene;
}

// What a thread of a game does: a viewer of its own, lists whose memory is used again.
std::size_t count_objects(const sightlines::table &table, const sl_view &view, bool shut) {
    sightlines::viewer viewer(table);
    viewer.set_method(SL_METHOD_EXACT, SL_STEPS_FRAME);
    if (shut) {
        viewer.close_door("door");
    }
    std::vector<std::uint32_t> objects;
    for (int frame = 0; frame < 3; ++frame) {
        viewer.look(view);
        viewer.objects(objects);
    }
    return objects.size();
}

} // namespace

int main() try {
    const sightlines::scene scene = rooms();
    const auto table = sightlines::bake(scene);
    const std::vector<std::uint8_t> bytes = table.bytes(SL_FORM_PACKED);
    const auto again = sightlines::table::from_bytes(bytes.data(), bytes.size());
    std::printf("%u cells, the first room is %s\n", static_cast<unsigned>(again.info().cell_count),
                again.cells_at({1, 1.5, 1.7}).empty() ? "outside" : "a place");

    const sl_view view = sightlines::perspective({1, 1.5, 1.7}, {1, 0, 0}, {0, 0, 1}, 1.0, 16.0 / 9.0);
    std::size_t open = 0, shut = 0;
    std::thread one([&] { open = count_objects(again, view, false); });
    std::thread other([&] { shut = count_objects(again, view, true); });
    one.join();
    other.join();
    std::printf("%zu objects through the open door, %zu with the door shut\n", open, shut);

    // What the callback throws leaves the bake.
    try {
        sightlines::bake(scene, {}, [](const sl_progress &) -> bool { throw std::logic_error("enough"); });
        return EXIT_FAILURE;
    } catch (const std::logic_error &thrown) {
        std::printf("the bake ended with: %s\n", thrown.what());
    }
    try {
        again.find_object("unicorn");
        return EXIT_FAILURE;
    } catch (const sightlines::error &failed) {
        std::printf("%s\n", failed.what());
        return failed.status() == SL_ERROR_NOT_FOUND && open > shut ? EXIT_SUCCESS : EXIT_FAILURE;
    }
} catch (const std::exception &thrown) {
    std::fprintf(stderr, "%s\n", thrown.what());
    return EXIT_FAILURE;
}
