MODULE FieldClientMotion
! The motion task beside field_client.mod: does one skill at a time, and gives its path up at a stop. An example, not run on
! a controller; your own moves come in at "yours".

PERS string trb_order := "";
PERS string trb_order_data := "";
PERS string trb_report := "";
PERS bool trb_stopped := FALSE;

VAR intnum trb_on_stop;

PROC main()
  IDelete trb_on_stop;
  CONNECT trb_on_stop WITH GiveUp;
  IPers trb_stopped, trb_on_stop;
  WHILE TRUE DO
    WaitUntil trb_order <> "" AND trb_report = "" AND NOT trb_stopped;
    TEST trb_order
    CASE "wave":
      WaitTime 0.5;                  ! yours: MoveJ ..., with the words of trb_order_data
    ENDTEST
    IF NOT trb_stopped trb_report := "done";
  ENDWHILE
ERROR
  trb_report := "failed";
  TRYNEXT;
ENDPROC

TRAP GiveUp
  IF NOT trb_stopped RETURN;
  StopMove \Quick;
  ClearPath;
  StartMove;
  ExitCycle;                         ! main begins anew, and waits for the release
ENDTRAP
ENDMODULE
