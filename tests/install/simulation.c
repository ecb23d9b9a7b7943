/* simulation.c: a stranger's program against the installed libawt: a groom, and no daemon. */
#include <awt.h>

#include <stdio.h>

int main(void)
{
    printf("%s\n", awt_status_text(AWT_OK));
    return 0;
}
