/* engine.c: a stranger's program, as C and as C++, against the installed libawtclient (suite.sh). */
#include <awtclient.h>

#include <stdio.h>
#include <string.h>

int main(void)
{
    awtclient_error error;
    awtclient_options options;
    proto_message message;
    awtframes_shown shown;
    float nose[3] = {0, 0, 1};
    awtframes *frames = awtframes_create(20000);
    memset(&options, 0, sizeof options);
    options.address = "nowhere";
    options.timeout_ms = 100;
    message.type = PROTO_LIST;
    awtspace_points_to(AWTSPACE_UNREAL, nose, nose, 1);
    if (!frames || awtframes_show(frames, 0, &shown) || awtclient_open(&options, &error) != NULL) {
        return 1;
    }
    awtframes_destroy(frames);
    printf("%s: %s; the nose is at %g cm\n", proto_type_name(message.type), error.text, (double)nose[0]);
    return error.code == AWTCLIENT_ADDRESS && nose[0] == 100 ? 0 : 1;
}
