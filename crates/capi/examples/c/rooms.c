/* Two rooms with a door between them: made into a table, stored, loaded again, and looked at.
 *
 * cc -std=c11 rooms.c -I include -L target/release -lsightlines_capi
 */
#include <sightlines.h>

#include <stdio.h>
#include <stdlib.h>

static void need(sl_status status, const char *what) {
    if (status != SL_OK) {
        fprintf(stderr, "%s: %s: %s\n", what, sl_status_name(status), sl_last_error());
        exit(EXIT_FAILURE);
    }
}

/* A box as twelve triangles that face outwards. */
static uint32_t add_box(sl_scene *scene, const char *name, const double min[3], const double max[3], uint32_t flags) {
    static const uint32_t indices[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                         2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    double corners[24];
    for (int i = 0; i < 8; ++i) {
        for (int k = 0; k < 3; ++k) {
            corners[3 * i + k] = (i >> k & 1) ? max[k] : min[k];
        }
    }
    uint32_t object = SL_NONE;
    need(sl_scene_add_object(scene, name, corners, 8, indices, 36, flags, &object), name);
    return object;
}

static int32_t on_progress(void *user, const sl_progress *progress) {
    unsigned *calls = user;
    ++*calls;
    return progress->share > 1.0; /* never: go on */
}

static sl_table *bake(void) {
    sl_scene *scene = NULL;
    need(sl_scene_new(&scene), "a scene");
    add_box(scene, "floor", (double[]){0, 0, -1}, (double[]){12, 6, 0}, 0);
    add_box(scene, "ceiling", (double[]){0, 0, 3}, (double[]){12, 6, 4}, 0);
    add_box(scene, "west", (double[]){-1, -1, -1}, (double[]){0, 7, 4}, 0);
    add_box(scene, "east", (double[]){12, -1, -1}, (double[]){13, 7, 4}, 0);
    add_box(scene, "south", (double[]){0, -1, -1}, (double[]){12, 0, 4}, 0);
    add_box(scene, "north", (double[]){0, 6, -1}, (double[]){12, 7, 4}, 0);
    /* The wall between the rooms, with an opening from y = 1 to y = 2, up to the ceiling. */
    add_box(scene, "wall/left", (double[]){6, 0, 0}, (double[]){6.5, 1, 3}, 0);
    add_box(scene, "wall/right", (double[]){6, 2, 0}, (double[]){6.5, 6, 3}, 0);
    add_box(scene, "door", (double[]){6.2, 1, 0}, (double[]){6.3, 2, 3}, SL_OBJECT_DOOR);
    add_box(scene, "chair", (double[]){2, 2, 0}, (double[]){2.5, 2.5, 1}, 0);
    add_box(scene, "table", (double[]){9, 1, 0}, (double[]){10, 2, 1}, 0);
    add_box(scene, "lamp", (double[]){7, 5, 0}, (double[]){7.3, 5.3, 2}, 0);

    unsigned calls = 0;
    sl_bake_options options = {.struct_size = sizeof options, .progress = on_progress, .user = &calls};
    sl_bake_report report = {.struct_size = sizeof report};
    sl_table *table = NULL;
    need(sl_bake(scene, &options, &table, &report), "bake");
    sl_scene_free(scene);
    printf("baked %u cells\n", (unsigned)report.cell_count);
    return calls > 0 ? table : NULL;
}

static sl_table *through_bytes(sl_table *table) {
    size_t size = 0;
    need(sl_table_bytes(table, SL_FORM_PLAIN, NULL, 0, &size), "size");
    uint8_t *bytes = malloc(size);
    if (bytes == NULL) {
        exit(EXIT_FAILURE);
    }
    need(sl_table_bytes(table, SL_FORM_PLAIN, bytes, size, &size), "bytes");
    sl_table_free(table);
    need(sl_table_from_bytes(bytes, size, &table), "load");
    free(bytes);
    return table;
}

static void print_visible(const sl_table *table, sl_viewer *viewer, const sl_view *view) {
    sl_answer answer;
    need(sl_viewer_look(viewer, view, &answer), "look");
    size_t count = 0;
    uint32_t objects[16];
    need(sl_viewer_objects(viewer, objects, 16, &count), "objects");
    printf("%u cells, %zu objects:", (unsigned)answer.cell_count, count);
    for (size_t i = 0; i < count; ++i) {
        char name[32];
        size_t length = 0;
        need(sl_table_object_name(table, objects[i], name, sizeof name, &length), "name");
        printf(" %s", name);
    }
    printf("%s\n", answer.is_outside ? " (outside: everything)" : "");
}

int main(void) {
    need(sl_check_version(SL_VERSION), "version");
    sl_table *table = through_bytes(bake());

    sl_table_info info = {.struct_size = sizeof info};
    need(sl_table_get_info(table, &info), "info");
    printf("%u cells, %u objects, %u portals, %u doors\n", (unsigned)info.cell_count, (unsigned)info.object_count,
           (unsigned)info.portal_count, (unsigned)info.door_count);

    sl_viewer *viewer = NULL;
    need(sl_viewer_new(table, &viewer), "viewer");
    sl_view view = {.kind = SL_VIEW_PERSPECTIVE,
                    .eye = {1, 1.5, 1.7},
                    .direction = {1, 0, 0},
                    .up = {0, 0, 1},
                    .field_of_view = 1.0,
                    .aspect = 16.0 / 9.0};
    print_visible(table, viewer, &view); /* through the door */
    need(sl_viewer_close_doors_named(viewer, "door"), "door");
    print_visible(table, viewer, &view); /* it is shut */
    view.eye[2] = 100;
    print_visible(table, viewer, &view); /* outside */

    /* What goes wrong is a status, and words. */
    uint32_t sees = 0;
    const sl_status status = sl_table_sees(table, 0, info.cell_count, &sees);
    printf("%s: %s\n", sl_status_name(status), sl_last_error());

    sl_table_free(table); /* the viewer does not need it */
    sl_viewer_free(viewer);
    return status == SL_ERROR_ARGUMENT ? EXIT_SUCCESS : EXIT_FAILURE;
}
