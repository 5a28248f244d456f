Include "";
