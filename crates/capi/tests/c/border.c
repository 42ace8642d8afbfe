/* What a careless caller does, and what threads do: every call returns, with the status that the header states. */
#include <sightlines.h>

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static unsigned n_checks;

#define EXPECT(status, call)                                                                                           \
    do {                                                                                                               \
        const sl_status found = (call);                                                                                \
        ++n_checks;                                                                                                    \
        if (found != (status)) {                                                                                       \
            fprintf(stderr, "line %d: %s instead of %s: %s\n", __LINE__, sl_status_name(found),                        \
                    sl_status_name(status), sl_last_error());                                                          \
            exit(EXIT_FAILURE);                                                                                        \
        }                                                                                                              \
    } while (0)

#define TRUE(condition)                                                                                                \
    do {                                                                                                               \
        ++n_checks;                                                                                                    \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "line %d: not so: %s\n", __LINE__, #condition);                                            \
            exit(EXIT_FAILURE);                                                                                        \
        }                                                                                                              \
    } while (0)

/* Three rooms in a row, in the plane: through the doors one sees from the first to the last. */
static const double walls[] = {0, 0, 9, 0, 9, 0, 9, 3, 9, 3, 0, 3, 0, 3, 0, 0, 3, 0, 3, 1, 3, 2, 3, 3, 6, 0, 6, 1, 6, 2, 6, 3};
#define N_WALLS (sizeof walls / sizeof walls[0] / 4)

typedef struct {
    const sl_table *table;
    unsigned n_answers;
    int failed;
} reader;

static void *read_table(void *argument) {
    reader *self = argument;
    sl_viewer *viewer = NULL;
    if (sl_viewer_new(self->table, &viewer) != SL_OK) {
        self->failed = 1;
        return NULL;
    }
    for (int i = 0; i < 200; ++i) {
        const double point[3] = {0.04 * i + 0.1, 1.5, 0};
        uint32_t cells[8];
        size_t n = 0;
        sl_view view = {.kind = SL_VIEW_PLANAR, .eye = {point[0], point[1], 0}, .direction = {1, 0, 0}, .field_of_view = 1};
        if (sl_table_cells_at(self->table, point, cells, 8, &n) != SL_OK || sl_viewer_look(viewer, &view, NULL) != SL_OK ||
            sl_table_sees(self->table, 0, 99, &cells[0]) != SL_ERROR_ARGUMENT || strstr(sl_last_error(), "99") == NULL) {
            self->failed = 1;
        }
        self->n_answers += n > 0;
    }
    sl_viewer_free(viewer);
    return NULL;
}

/* A callback that asks for the handle that is in use, and then cancels. */
typedef struct {
    sl_scene *scene;
    unsigned n_calls;
} nosy;

static int32_t ask_and_cancel(void *user, const sl_progress *progress) {
    nosy *self = user;
    ++self->n_calls;
    const double corner[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t triangle[3] = {0, 1, 2};
    EXPECT(SL_ERROR_BUSY, sl_scene_add_object(self->scene, "late", corner, 3, triangle, 3, 0, NULL));
    return strlen(progress->phase) > 0;
}

static void scenes(void) {
    sl_scene *scene = NULL;
    sl_table *table = (sl_table *)&scene;
    const double corners[12] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 4};
    const uint32_t faces[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    uint32_t object = 7;
    EXPECT(SL_ERROR_NULL, sl_scene_new(NULL));
    EXPECT(SL_OK, sl_scene_new(&scene));
    EXPECT(SL_ERROR_NULL, sl_scene_add_object(NULL, "a", corners, 4, faces, 12, 0, &object));
    EXPECT(SL_ERROR_NULL, sl_scene_add_object(scene, "a", NULL, 4, faces, 12, 0, &object));
    EXPECT(SL_ERROR_NULL, sl_scene_add_object(scene, "a", corners, 4, NULL, 12, 0, &object));
    EXPECT(SL_ERROR_GEOMETRY, sl_scene_add_object(scene, "a", corners, 3, faces, 12, 0, &object));
    EXPECT(SL_ERROR_GEOMETRY, sl_scene_add_object(scene, "a", corners, 4, faces, 11, 0, &object));
    EXPECT(SL_ERROR_ARGUMENT, sl_scene_add_object(scene, "a", corners, 4, faces, 12, 1u << 30, &object));
    EXPECT(SL_ERROR_ARGUMENT, sl_scene_add_object(scene, "\xff", corners, 4, faces, 12, 0, &object));
    EXPECT(SL_ERROR_ARGUMENT, sl_scene_add_object(scene, "a", corners, SIZE_MAX, faces, 12, 0, &object));
    EXPECT(SL_ERROR_ARGUMENT,
           sl_scene_add_object(scene, "a", (const double *)((const char *)corners + 4), 3, faces, 3, 0, &object));
    double nan_corners[12];
    memcpy(nan_corners, corners, sizeof corners);
    nan_corners[4] = NAN;
    EXPECT(SL_ERROR_GEOMETRY, sl_scene_add_object(scene, "a", nan_corners, 4, faces, 12, 0, &object));
    TRUE(strstr(sl_last_error(), "object 0, vertex 1") != NULL && object == 7);
    EXPECT(SL_OK, sl_scene_add_object(scene, NULL, corners, 4, faces, 12, 0, &object));
    TRUE(object == 0);
    const float single[9] = {1, 1, 1, 2, 1, 1, 1, 2, INFINITY};
    EXPECT(SL_ERROR_GEOMETRY, sl_scene_add_object_f32(scene, "b", single, 3, faces, 3, 0, NULL));
    EXPECT(SL_ERROR_ARGUMENT, sl_scene_set_motion(scene, 1, NULL));
    const sl_box nowhere = {{NAN, 0, 0}, {1, 1, 1}};
    EXPECT(SL_ERROR_GEOMETRY, sl_scene_set_motion(scene, 0, &nowhere));

    sl_bake_options options = {0};
    EXPECT(SL_ERROR_VERSION, sl_bake(scene, &options, &table, NULL));
    TRUE(table == NULL);
    options.struct_size = sizeof options;
    sl_bake_report report = {0};
    EXPECT(SL_ERROR_VERSION, sl_bake(scene, &options, &table, &report));
    EXPECT(SL_ERROR_NULL, sl_bake(scene, &options, NULL, NULL));
    options.method = "magic";
    EXPECT(SL_ERROR_ARGUMENT, sl_bake(scene, &options, &table, NULL));
    options.method = NULL;
    options.gap = NAN;
    EXPECT(SL_ERROR_ARGUMENT, sl_bake(scene, &options, &table, NULL));
    options.gap = 0;
    options.cells = 99;
    EXPECT(SL_ERROR_ARGUMENT, sl_bake(scene, &options, &table, NULL));
    options.cells = SL_CELLS_BOXES;
    EXPECT(SL_ERROR_ARGUMENT, sl_bake(scene, &options, &table, NULL));
    options.cells = SL_CELLS_GRID;
    options.grid[0] = options.grid[1] = options.grid[2] = 1u << 20;
    EXPECT(SL_ERROR_BAKE, sl_bake(scene, &options, &table, NULL));
    options.grid[0] = options.grid[1] = options.grid[2] = 2;
    nosy user = {scene, 0};
    options.progress = ask_and_cancel;
    options.user = &user;
    EXPECT(SL_ERROR_CANCELLED, sl_bake(scene, &options, &table, NULL));
    TRUE(user.n_calls == 1 && table == NULL);
    options.progress = NULL;
    EXPECT(SL_OK, sl_bake(scene, &options, &table, NULL));
    sl_table *none = table;
    EXPECT(SL_ERROR_HANDLE, sl_bake((const sl_scene *)table, &options, &none, NULL));
    TRUE(none == NULL);
    sl_table_free(table);
    sl_scene_free(scene);
    sl_scene_free(NULL);
}

static void tables(sl_table *table) {
    size_t n = 0, size = 0;
    uint32_t cell = 0, answer = 0;
    char text[4];
    static uint64_t nothing[16];
    const sl_table *no_table = (const sl_table *)nothing;
    sl_table *other = table;
    EXPECT(SL_ERROR_NULL, sl_table_load(NULL, &other));
    TRUE(other == NULL);
    EXPECT(SL_ERROR_FILE, sl_table_load("/nowhere/at/all.pvs", &other));
    EXPECT(SL_ERROR_FORMAT, sl_table_from_bytes((const uint8_t *)"garbage", 7, &other));
    EXPECT(SL_ERROR_FORMAT, sl_table_from_bytes(NULL, 0, &other));
    EXPECT(SL_ERROR_NULL, sl_table_from_bytes(NULL, 7, &other));
    EXPECT(SL_ERROR_FILE, sl_table_save(table, "/nowhere/at/all.pvs", SL_FORM_PLAIN));
    EXPECT(SL_ERROR_HANDLE, sl_table_sees(no_table, 0, 0, &answer));
    EXPECT(SL_ERROR_HANDLE, sl_table_sees((const sl_table *)((const char *)nothing + 1), 0, 0, &answer));
    EXPECT(SL_ERROR_NULL, sl_table_sees(NULL, 0, 0, &answer));
    EXPECT(SL_ERROR_NULL, sl_table_sees(table, 0, 0, NULL));
    EXPECT(SL_ERROR_ARGUMENT, sl_table_sees(table, SL_NONE, 0, &answer));

    EXPECT(SL_ERROR_ARGUMENT, sl_table_bytes(table, 9, NULL, 0, &size));
    for (uint32_t form = SL_FORM_PLAIN; form <= SL_FORM_PACKED; ++form) {
        EXPECT(SL_OK, sl_table_bytes(table, form, NULL, 0, &size));
        uint8_t *bytes = malloc(size);
        TRUE(bytes != NULL);
        EXPECT(SL_ERROR_BUFFER, sl_table_bytes(table, form, bytes, size - 1, &n));
        EXPECT(SL_OK, sl_table_bytes(table, form, bytes, size, &n));
        EXPECT(SL_OK, sl_table_from_bytes(bytes, size, &other));
        sl_table_free(other);
        bytes[size / 2] ^= 4;
        EXPECT(SL_ERROR_FORMAT, sl_table_from_bytes(bytes, size, &other));
        EXPECT(SL_ERROR_FORMAT, sl_table_from_bytes(bytes, size / 2, &other));
        free(bytes);
    }

    const double inside[3] = {1, 1.5, 99}, outside[3] = {-5, 0, 0}, no_number[3] = {NAN, 0, 0};
    EXPECT(SL_OK, sl_table_cells_at(table, inside, &cell, 1, &n));
    TRUE(n == 1);
    EXPECT(SL_OK, sl_table_cells_at(table, outside, NULL, 0, &n));
    TRUE(n == 0);
    EXPECT(SL_OK, sl_table_cells_at(table, no_number, &cell, 1, &n));
    TRUE(n == 0);
    EXPECT(SL_ERROR_NULL, sl_table_cells_at(table, NULL, &cell, 1, &n));
    EXPECT(SL_ERROR_NULL, sl_table_cells_at(table, inside, NULL, 1, &n));
    EXPECT(SL_ERROR_NULL, sl_table_cells_at(table, inside, &cell, 1, NULL));

    sl_table_info info = {0};
    EXPECT(SL_ERROR_VERSION, sl_table_get_info(table, &info));
    info.struct_size = sizeof info;
    EXPECT(SL_OK, sl_table_get_info(table, &info));
    TRUE(info.dimension == 2 && info.cell_count >= 3 && info.portal_count >= 2 && info.has_digest == 1);
    EXPECT(SL_OK, sl_table_visible_cells_at(table, outside, NULL, 0, &n, &answer));
    TRUE(answer == 1 && n == info.cell_count);
    EXPECT(SL_ERROR_ARGUMENT, sl_table_cell_corners(table, info.cell_count, NULL, 0, &n));
    EXPECT(SL_ERROR_ARGUMENT, sl_table_object_name(table, 0, text, sizeof text, &n));
    EXPECT(SL_ERROR_NOT_FOUND, sl_table_find_object(table, "x", &answer));
    EXPECT(SL_OK, sl_table_find_doors(table, "x", NULL, 0, &n));
    TRUE(n == 0);
    const uint64_t *row = NULL;
    EXPECT(SL_OK, sl_table_row(table, cell, &row, &n));
    TRUE(n == (info.cell_count + 63) / 64 && (row[cell / 64] >> (cell % 64) & 1) == 1);
}

static void viewers(sl_table *table) {
    sl_viewer *viewer = NULL;
    EXPECT(SL_ERROR_NULL, sl_viewer_new(NULL, &viewer));
    EXPECT(SL_OK, sl_viewer_new(table, &viewer));
    sl_answer answer;
    size_t n = 1;
    EXPECT(SL_OK, sl_viewer_cells(viewer, NULL, 0, &n));
    TRUE(n == 0);
    sl_view view = {.kind = SL_VIEW_PLANAR, .eye = {1, 1.5, 7}, .direction = {1, 0, 0}, .field_of_view = 1};
    EXPECT(SL_OK, sl_viewer_look(viewer, &view, &answer));
    TRUE(answer.is_outside == 0 && answer.method == SL_METHOD_EXACT && answer.cell_count >= 3);
    const uint32_t n_open = answer.cell_count;
    uint32_t portals[64];
    EXPECT(SL_OK, sl_viewer_portals(viewer, portals, 64, &n));
    TRUE(n >= 2);
    for (size_t i = 0; i < n; ++i) {
        EXPECT(SL_OK, sl_viewer_close_portal(viewer, portals[i]));
    }
    EXPECT(SL_ERROR_ARGUMENT, sl_viewer_close_portal(viewer, 1000000));
    EXPECT(SL_OK, sl_viewer_look(viewer, &view, &answer));
    TRUE(answer.cell_count < n_open);
    EXPECT(SL_OK, sl_viewer_open_all(viewer));
    view.field_of_view = 0;
    EXPECT(SL_ERROR_VIEW, sl_viewer_look(viewer, &view, &answer));
    view.kind = SL_VIEW_PERSPECTIVE;
    EXPECT(SL_ERROR_VIEW, sl_viewer_look(viewer, &view, &answer));
    view.kind = 77;
    EXPECT(SL_ERROR_ARGUMENT, sl_viewer_look(viewer, &view, &answer));
    view.kind = SL_VIEW_ALL_ROUND;
    view.eye[0] = -3;
    EXPECT(SL_OK, sl_viewer_look(viewer, &view, &answer));
    TRUE(answer.is_outside == 1 && answer.method == SL_NONE);
    EXPECT(SL_ERROR_ARGUMENT, sl_viewer_set_method(viewer, 5, 0));
    EXPECT(SL_ERROR_NULL, sl_viewer_look(viewer, NULL, &answer));
    EXPECT(SL_ERROR_HANDLE, sl_viewer_look((sl_viewer *)table, &view, &answer));
    sl_viewer_free((sl_viewer *)table); /* not a viewer: nothing is done */
    sl_viewer_free(viewer);
}

int main(void) {
    EXPECT(SL_OK, sl_check_version(SL_VERSION));
    TRUE(sl_version() == SL_VERSION);
    EXPECT(SL_ERROR_VERSION, sl_check_version(SL_VERSION + 1000));
    scenes();
    sl_table *table = NULL;
    EXPECT(SL_OK, sl_bake_plan(walls, N_WALLS, NULL, &table, NULL));
    tables(table);
    viewers(table);
    pthread_t threads[4];
    reader readers[4];
    for (int i = 0; i < 4; ++i) {
        readers[i] = (reader){table, 0, 0};
        TRUE(pthread_create(&threads[i], NULL, read_table, &readers[i]) == 0);
    }
    for (int i = 0; i < 4; ++i) {
        TRUE(pthread_join(threads[i], NULL) == 0);
        TRUE(readers[i].failed == 0 && readers[i].n_answers == 200);
    }
    sl_table_free(table);
    printf("%u checks\n", n_checks);
    return EXIT_SUCCESS;
}
