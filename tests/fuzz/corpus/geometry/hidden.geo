a = "x\"; SystemCall "touch y"; //";
SystemCall("id");
