/* test_metrics.c: what is counted, and how /metrics writes it. */
#include "check.h"
#include "metrics.h"
#include "metrics_text.h"
#include "process.h"
#include "prometheus.h"
#include "proto.h"
#include "server_fixture.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

TEST(metrics_histogram_bounds_are_two_to_each_doubling)
{
    static const uint64_t first[] = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32};
    for (size_t i = 0; i < sizeof first / sizeof first[0]; i++) {
        CHECK_U64(histogram_bound_us(i), first[i]);
    }
    CHECK_U64(histogram_bound_us(HISTOGRAM_BOUNDS - 1), UINT64_C(1) << 25);
}

TEST(metrics_histogram_counts_a_value_in_the_first_bucket_that_holds_it)
{
    for (size_t i = 0; i < HISTOGRAM_BOUNDS; i++) {
        CHECK_U64(histogram_bucket(histogram_bound_us(i)), i);
        CHECK_U64(histogram_bucket(histogram_bound_us(i) + 1), i + 1);
    }
    CHECK_U64(histogram_bucket(0), 0);
    CHECK_U64(histogram_bucket(UINT64_MAX), HISTOGRAM_BOUNDS);
}

enum { THREADS = 24, ROUNDS = 2000 };

static void *count_much(void *nothing)
{
    (void)nothing;
    for (int i = 0; i < ROUNDS; i++) {
        metrics_count(METRIC_STEPS, 3);
        metrics_observe(METRIC_STEP, 5);
        metrics_count_error(PROTO_ERROR_BUSY);
        metrics_add(METRIC_JOBS_WAITING, i % 2 ? -1 : 1);
    }
    return NULL;
}

TEST(metrics_lose_nothing_that_many_threads_count)
{
    pthread_t threads[THREADS];
    const uint64_t steps = metrics_counted(METRIC_STEPS), busy = metrics_counted_errors(PROTO_ERROR_BUSY);
    const int64_t waiting = metrics_gauge_value(METRIC_JOBS_WAITING);
    const metrics_distribution before = metrics_distribution_of(METRIC_STEP);
    for (int i = 0; i < THREADS; i++) {
        CHECK(pthread_create(&threads[i], NULL, count_much, NULL) == 0);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
    }
    const metrics_distribution after = metrics_distribution_of(METRIC_STEP);
    CHECK_U64(metrics_counted(METRIC_STEPS) - steps, 3 * THREADS * ROUNDS);
    CHECK_U64(metrics_counted_errors(PROTO_ERROR_BUSY) - busy, THREADS * ROUNDS);
    CHECK_INT(metrics_gauge_value(METRIC_JOBS_WAITING), waiting);
    CHECK_U64(after.count[histogram_bucket(5)] - before.count[histogram_bucket(5)], THREADS * ROUNDS);
    CHECK_U64(after.sum_us - before.sum_us, 5 * THREADS * ROUNDS);
}

/* All that /metrics would say; heap. */
static char *written(void)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    CHECK(file != NULL);
    metrics_write(file);
    fclose(file);
    return text;
}

TEST(metrics_are_written_as_prometheus_reads_them)
{
    char error[256] = "";
    process_note_start();
    char *text = written();
    const double before = prometheus_value(text, "awtd_step_seconds_count");
    free(text);
    metrics_count(METRIC_STEPS, 1);
    metrics_observe(METRIC_STEP, 700);
    metrics_observe(METRIC_STEP, UINT64_C(1) << 40);
    text = written();
    prometheus_result result = prometheus_check(text, error, sizeof error);
    CHECK_TEXT(error, "");
    CHECK(result.families > 20);
    CHECK(prometheus_value(text, "awtd_steps_total") >= 1);
    CHECK_NEAR(prometheus_value(text, "awtd_step_seconds_count"), before + 2, 0);
    CHECK(prometheus_value(text, "awtd_step_seconds_bucket{le=\"+Inf\"}") ==
          prometheus_value(text, "awtd_step_seconds_count"));
    CHECK(prometheus_value(text, "awtd_step_seconds_sum") >= 1099511.0);
    CHECK(prometheus_value(text, "process_start_time_seconds") > 1.6e9);
    CHECK(prometheus_value(text, "process_cpu_seconds_total") >= 0);
    free(text);
}

TEST(metrics_pass_prometheuss_own_check)
{
    char path[] = "/tmp/awtd-test-XXXXXX", command[128];
    if (system("command -v promtool >/dev/null 2>&1") != 0) {
        check_skip("no promtool here (Debian's prometheus)");
        return;
    }
    FILE *file = fdopen(mkstemp(path), "w");
    CHECK(file != NULL);
    metrics_write(file);
    fclose(file);
    snprintf(command, sizeof command, "promtool check metrics <%s", path);
    CHECK_INT(system(command), 0);
    unlink(path);
}

TEST(metrics_reader_of_the_tests_refuses_what_is_not_the_format)
{
    static const char *const wrong[] = {
        "a_total 1\n",                                                                   /* no TYPE */
        "# HELP a_total x\n# TYPE a_total counter\na_total 1",                           /* no end of line */
        "# HELP a_total x\n# TYPE a_total counter\na_total one\n",                       /* no number */
        "# HELP a_total x\n# TYPE a_total counter\na_total 1\na_total 1\n",              /* twice */
        "# HELP a_total x\n# TYPE a_total counter\n# TYPE a_total counter\na_total 1\n", /* twice */
        "# HELP a x\n# TYPE a counter\na 1\n",                                           /* a counter is ..._total */
        "# HELP a_total x\n# TYPE a_total counter\na_total -1\n",                        /* less than nothing */
        "# HELP a x\n# TYPE a gauge\na{b=\"c} 1\n",                                      /* no end of the label */
        "# HELP a x\n# TYPE a gauge\n1a 1\n",                                            /* no name */
        "# HELP a x\n# TYPE a histogram\na_bucket{le=\"1\"} 2\na_bucket{le=\"+Inf\"} 1\na_sum 1\na_count 1\n",
        "# HELP a x\n# TYPE a histogram\na_bucket{le=\"2\"} 1\na_bucket{le=\"+Inf\"} 1\na_bucket{le=\"3\"} 1\n",
        "# HELP a x\n# TYPE a histogram\na_bucket{le=\"1\"} 1\na_sum 1\na_count 1\n", /* no +Inf */
        "# HELP a x\n# TYPE a histogram\na_bucket{le=\"+Inf\"} 1\na_sum 1\na_count 2\n"};
    char error[256];
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        error[0] = '\0';
        prometheus_check(wrong[i], error, sizeof error);
        CHECK(error[0] != '\0');
    }
}

TEST(metrics_count_what_a_session_does_and_fall_back_when_all_has_ended)
{
    service shared;
    const int64_t forests = metrics_gauge_value(METRIC_FORESTS), bytes = metrics_gauge_value(METRIC_HAIR_BYTES),
                  asleep = metrics_gauge_value(METRIC_FORESTS_ASLEEP),
                  waiting = metrics_gauge_value(METRIC_JOBS_WAITING),
                  running = metrics_gauge_value(METRIC_JOBS_RUNNING),
                  connections = metrics_gauge_value(METRIC_CONNECTIONS);
    const uint64_t frames = metrics_counted(METRIC_FRAMES_ENCODED),
                   unknown = metrics_counted_errors(PROTO_ERROR_NO_FOREST);
    CHECK(fake_service_init(&shared, 0, 4, false));
    fake_client *client = fake_client_open(&shared);
    struct proto_create_reply made = fake_make_forest(&shared, client, 1);
    CHECK_INT(metrics_gauge_value(METRIC_CONNECTIONS), connections + 1);
    CHECK_INT(metrics_gauge_value(METRIC_FORESTS), forests + 1);
    CHECK_INT(metrics_gauge_value(METRIC_HAIR_BYTES) - bytes, (long long)registry_bytes(&shared.forests));
    CHECK_INT(metrics_gauge_value(METRIC_JOBS_WAITING), waiting);
    proto_message query = fake_query(made.forest, 50000);
    CHECK(fake_send(client, &query));
    CHECK_INT(metrics_gauge_value(METRIC_JOBS_WAITING), waiting + 1);
    fake_work(&shared, client);
    fake_expect(client, PROTO_FRAME);
    CHECK(metrics_counted(METRIC_FRAMES_ENCODED) > frames);
    query.as.query.forest ^= 1;
    CHECK(fake_send(client, &query));
    fake_expect_error(client, PROTO_ERROR_NO_FOREST);
    CHECK_U64(metrics_counted_errors(PROTO_ERROR_NO_FOREST), unknown + 1);
    fake_client_destroy(client);
    service_fini(&shared);
    CHECK_INT(metrics_gauge_value(METRIC_CONNECTIONS), connections);
    CHECK_INT(metrics_gauge_value(METRIC_FORESTS), forests);
    CHECK_INT(metrics_gauge_value(METRIC_FORESTS_ASLEEP), asleep);
    CHECK_INT(metrics_gauge_value(METRIC_HAIR_BYTES), bytes);
    CHECK_INT(metrics_gauge_value(METRIC_JOBS_WAITING), waiting);
    CHECK_INT(metrics_gauge_value(METRIC_JOBS_RUNNING), running);
}
